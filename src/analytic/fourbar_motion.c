// Finds where coupler and follower stand at a crank angle and how they move, in closed form.
//
// r2 = a (cos t, sin t) crank, r3 from crank pin A to coupler pin P, r4 from follower pivot to P:
//     D = (g, 0) - r2,  d = |D|
//     r3 = p D +- q z x D,  p = (b^2 - c^2 + d^2) / (2 d^2)
//     q = sqrt(((b + d)^2 - c^2) (c^2 - (b - d)^2)) / (2 d^2)         + open, - crossed
//     w3 = -w (r4 x r2) / (r4 x r3),   w4 = w (r3 x r2) / (r3 x r4)
//     s = w^2 r2 + w3^2 r3 - w4^2 r4,  al3 = s.r4 / (r3 x r4),  al4 = s.r3 / (r3 x r4)
// from differentiating r2 + r3 = (g, 0) + r4 twice at constant w. The product form of q keeps its
// digits near a dead centre, where b^2 - (p d)^2 loses them. Lengths m, angles rad.
#include "analytic/fourbar_motion.h"

#include <assert.h>
#include <math.h>

typedef struct Loop {
    Vec2 r2;
    Vec2 r3;
    Vec2 r4;
    double omega3;
    double omega4;
    double alpha3;
    double alpha4;
} Loop;

FourBarLengths fourbar_motion_nominal(const FourBar *fourbar)
{
    return (FourBarLengths){
        .ground = fourbar->ground.nominal,
        .crank = fourbar->crank.nominal,
        .coupler = fourbar->coupler.nominal,
        .follower = fourbar->follower.nominal,
        .assembly = fourbar->assembly,
    };
}

// The crank as a unit vector.
static inline Vec2 direction_of(double crank_angle)
{
    return (Vec2){cos(crank_angle), sin(crank_angle)};
}

static inline Loop close_loop(const FourBarLengths *lengths, double speed, Vec2 crank)
{
    const double b = lengths->coupler;
    const double c = lengths->follower;
    Loop loop;

    // the two triangles share the diagonal from crank pin to follower pivot
    loop.r2 = vec2_scale(lengths->crank, crank);
    const Vec2 diagonal = {lengths->ground - loop.r2.x, -loop.r2.y};
    const double d2 = vec2_dot(diagonal, diagonal);
    const double d = sqrt(d2);
    const double p = (b * b - c * c + d2) / (2.0 * d2);
    const double product = (b + d - c) * (b + d + c) * (c - b + d) * (c + b - d);
    const double q = sqrt(product) / (2.0 * d2);
    const double side = lengths->assembly == ASSEMBLY_OPEN ? q : -q;
    loop.r3 = vec2_add(vec2_scale(p, diagonal), vec2_scale(side, vec2_perp(diagonal)));
    loop.r4 = vec2_sub(loop.r3, diagonal);

    // each rate follows from one cross product with the other link
    const double area = vec2_cross(loop.r3, loop.r4);
    loop.omega3 = speed * vec2_cross(loop.r4, loop.r2) / area;
    loop.omega4 = speed * vec2_cross(loop.r3, loop.r2) / area;
    const Vec2 s = vec2_sub(vec2_add(vec2_scale(speed * speed, loop.r2),
                                     vec2_scale(loop.omega3 * loop.omega3, loop.r3)),
                            vec2_scale(loop.omega4 * loop.omega4, loop.r4));
    loop.alpha3 = vec2_dot(s, loop.r4) / area;
    loop.alpha4 = vec2_dot(s, loop.r3) / area;
    return loop;
}

static inline void put(double *array, size_t index, double value)
{
    if (array != NULL) {
        array[index] = value;
    }
}

void fourbar_motion_grid(const FourBarLengths *lengths, double speed, size_t count,
                         const double *crank_angles, const FourBarGrid *grid)
{
    for (size_t i = 0; i < count; i++) {
        const Loop loop = close_loop(lengths, speed, direction_of(crank_angles[i]));
        if (grid->follower_angle != NULL) {
            grid->follower_angle[i] = atan2(loop.r4.y, loop.r4.x);
        }
        put(grid->coupler_omega, i, loop.omega3);
        put(grid->follower_omega, i, loop.omega4);
        put(grid->coupler_alpha, i, loop.alpha3);
        put(grid->follower_alpha, i, loop.alpha4);
    }
}

// The centre of a link that starts at `first` with the vector `link` and turns; `carried` is the
// velocity and `pushed` the acceleration of its first end.
static Motion link_motion(Vec2 first, Vec2 link, Vec2 carried, Vec2 pushed, double omega,
                          double alpha)
{
    const Vec2 half = vec2_scale(0.5, link);
    const Vec2 turned = vec2_perp(half);
    return (Motion){
        .position = vec2_add(first, half),
        .angle = atan2(link.y, link.x),
        .velocity = vec2_add(carried, vec2_scale(omega, turned)),
        .omega = omega,
        .acceleration =
            vec2_add(pushed, vec2_sub(vec2_scale(alpha, turned), vec2_scale(omega * omega, half))),
        .alpha = alpha,
    };
}

bool fourbar_motion_bodies(const FourBarLengths *lengths, double speed, double crank_angle,
                           Motion motions[3])
{
    const Loop loop = close_loop(lengths, speed, direction_of(crank_angle));
    if (!isfinite(loop.alpha3) || !isfinite(loop.alpha4)) {
        return false;
    }
    const Vec2 still = {0.0, 0.0};
    motions[0] = link_motion(still, loop.r2, still, still, speed, 0.0);
    motions[0].angle = crank_angle;
    const Vec2 pin_velocity = vec2_scale(speed, vec2_perp(loop.r2));
    const Vec2 pin_acceleration = vec2_scale(-speed * speed, loop.r2);
    motions[1] =
        link_motion(loop.r2, loop.r3, pin_velocity, pin_acceleration, loop.omega3, loop.alpha3);
    motions[2] =
        link_motion((Vec2){lengths->ground, 0.0}, loop.r4, still, still, loop.omega4, loop.alpha4);
    return true;
}

static double loop_quantity(const Loop *loop, FourBarQuantity quantity)
{
    switch (quantity) {
    case FOURBAR_COUPLER_OMEGA:
        return loop->omega3;
    case FOURBAR_FOLLOWER_OMEGA:
        return loop->omega4;
    case FOURBAR_COUPLER_ALPHA:
        return loop->alpha3;
    case FOURBAR_FOLLOWER_ALPHA:
        return loop->alpha4;
    case FOURBAR_FOLLOWER_ANGLE:
        return atan2(-loop->r4.y, -loop->r4.x) + M_PI;
    default:
        return atan2(fabs(vec2_cross(loop->r3, loop->r4)), fabs(vec2_dot(loop->r3, loop->r4)));
    }
}

double fourbar_motion_quantity(const FourBarLengths *lengths, double speed,
                               FourBarQuantity quantity, double crank_angle)
{
    const Loop loop = close_loop(lengths, speed, direction_of(crank_angle));
    return loop_quantity(&loop, quantity);
}

void fourbar_motion_quantities(const FourBarLengths *lengths, double speed, Vec2 crank,
                               double values[FOURBAR_QUANTITY_COUNT])
{
    const Loop loop = close_loop(lengths, speed, crank);
    for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
        values[quantity] = loop_quantity(&loop, quantity);
    }
}

typedef struct FourBarCurve {
    const FourBarLengths *lengths;
    double speed;
    FourBarQuantity quantity;
} FourBarCurve;

static double fourbar_value(double crank_angle, void *context)
{
    const FourBarCurve *curve = context;
    return fourbar_motion_quantity(curve->lengths, curve->speed, curve->quantity, crank_angle);
}

CurveExtreme fourbar_motion_extreme(const FourBarLengths *lengths, double speed,
                                    FourBarQuantity quantity, double first_angle, double last_angle)
{
    FourBarCurve curve = {lengths, speed, quantity};
    return curve_extreme(fourbar_value, &curve, first_angle, last_angle);
}

void fourbar_motion_turn(FourBarTurn *turn)
{
    turn->grid = curve_grid(0.0, 2.0 * M_PI);
    assert(turn->grid.count <= FOURBAR_TURN_MAX);
    for (size_t i = 0; i < turn->grid.count; i++) {
        turn->cranks[i] = direction_of(curve_grid_angle(&turn->grid, i));
    }
}

double fourbar_motion_bound(const FourBarLengths *lengths, double speed, FourBarQuantity quantity,
                            bool is_high, const FourBarTurn *turn)
{
    double samples[FOURBAR_TURN_MAX];
    for (size_t i = 0; i < turn->grid.count; i++) {
        const Loop loop = close_loop(lengths, speed, turn->cranks[i]);
        samples[i] = loop_quantity(&loop, quantity);
    }
    FourBarCurve curve = {lengths, speed, quantity};
    return curve_bound(fourbar_value, &curve, &turn->grid, samples, is_high, NULL);
}

// Do flanks of gears stand as far apart as the curves of their teeth do?
//
// The involute of a base circle of radius r about a centre C, where its normal is n: with T = C -+
// r perp n the point where the line along n leaves the circle (- of gear a, + of gear b),
//     P = T + (p -+ r tau) n,   n turned by tau
// as the string unwinds. Two gears, turned and moved, have flanks whose least distance is found by
// search alone.
#include "close.h"

#include "model/coordinate.h"

enum { EXTERNAL, INTERNAL, KINDS, STEPS = 80 };

static const double ALPHA = 20.0 * M_PI / 180.0;
static const double DISTANCE = 0.08; // m

static Gear gear_of(int kind)
{
    const double teeth[2] = {20.0, kind == EXTERNAL ? 60.0 : -70.0};
    const double sum = teeth[0] + teeth[1];
    return (Gear){
        .teeth = {teeth[0], teeth[1]},
        .radius_a = DISTANCE * teeth[0] / sum,
        .radius_b = DISTANCE * teeth[1] / sum,
        .pressure_angle = ALPHA,
    };
}

// A flank's curve on its gear, as it stands with the gears untouched.
typedef struct Curve {
    double side;   // -1 of gear a, 1 of gear b
    double radius; // m, of the base circle
    double normal; // rad
    double string; // m, p above
    double sign;   // of the flank
} Curve;

static Vec2 point_of(const Curve *curve, Vec2 centre, double turned, double tau)
{
    const Vec2 n = vec2_rotate(curve->normal + tau + turned, (Vec2){1.0, 0.0});
    const double radius = curve->sign * curve->radius;
    const Vec2 left = vec2_scale(curve->side * radius, vec2_perp(n));
    const double string = curve->string + curve->side * radius * tau;
    return vec2_add(centre, vec2_add(left, vec2_scale(string, n)));
}

// The least of a function of one variable between two, by the golden section.
typedef double (*Function)(double at, void *context);

static double least_of(Function of, void *context, double low, double high)
{
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    for (int i = 0; i < STEPS; i++) {
        const double width = golden * (high - low);
        *(of(high - width, context) < of(low + width, context) ? &high : &low) =
            of(high - width, context) < of(low + width, context) ? low + width : high - width;
    }
    return of(0.5 * (low + high), context);
}

typedef struct Pair {
    Curve curves[2];
    Vec2 centres[2];
    double turned[2];
    double tau; // of the first curve
} Pair;

static double between(double tau, void *context)
{
    const Pair *pair = context;
    const Vec2 a = point_of(&pair->curves[0], pair->centres[0], pair->turned[0], pair->tau);
    const Vec2 b = point_of(&pair->curves[1], pair->centres[1], pair->turned[1], tau);
    return vec2_length(vec2_sub(b, a));
}

static double from_first(double tau, void *context)
{
    Pair *pair = context;
    pair->tau = tau;
    return least_of(between, pair, -0.2, 0.2);
}

static Pair pair_of(const Gear *gear, double sign)
{
    const double e = gear->radius_a * gear->radius_b > 0.0 ? 1.0 : -1.0;
    const double normal = sign * (0.5 * M_PI - e * ALPHA);
    const double line = vec2_dot(vec2_rotate(normal, (Vec2){1.0, 0.0}), (Vec2){DISTANCE, 0.0});
    const double base[2] = {gear->radius_a * cos(ALPHA), gear->radius_b * cos(ALPHA)};
    // where the line of action crosses that of the centres both touch
    const double crossed = line * gear->radius_a / DISTANCE;
    return (Pair){
        .curves = {{-1.0, base[0], normal, crossed, sign},
                   {1.0, base[1], normal, crossed - line, sign}},
        .centres = {{0.0, 0.0}, {DISTANCE, 0.0}},
    };
}

static double gap_by_search(const Gear *gear, double sign, const double turned[2], Vec2 centre_b)
{
    Pair pair = pair_of(gear, sign);
    pair.turned[0] = turned[0];
    pair.turned[1] = turned[1];
    pair.centres[1] = centre_b;
    return least_of(from_first, &pair, -0.2, 0.2);
}

static double gap_of(const Mesh *mesh, double sign, const double turned[2], Vec2 centre_b)
{
    const MeshFlank flank = mesh_flank(mesh, sign, centre_b, turned[0], turned[1]);
    const double q = mesh_position(mesh->gear, centre_b, turned[0], turned[1], 0.0);
    return mesh_gap(mesh->gear, &flank, sign * q, vec2_length(centre_b) - DISTANCE);
}

static void flanks_are_as_far_apart_as_their_curves(void **state)
{
    (void)state;
    static const Vec2 CENTRES[] = {
        {DISTANCE, 0.0}, {DISTANCE + 2e-4, 0.0}, {DISTANCE - 1e-4, 3e-4}, {DISTANCE + 1e-3, -2e-4}};
    for (int kind = 0; kind < KINDS; kind++) {
        const Gear gear = gear_of(kind);
        const Mesh mesh = {.gear = &gear};
        for (int i = 0; i < 8; i++) {
            const double sign = i % 2 == 0 ? 1.0 : -1.0;
            // apart by a millimetre, so that a distance can be searched
            const double turned[2] = {0.03, (-sign * 1e-3 - 0.03 * gear.radius_a) / gear.radius_b};
            const double found = gap_by_search(&gear, sign, turned, CENTRES[i / 2]);
            assert_near(gap_of(&mesh, sign, turned, CENTRES[i / 2]), found, 1e-11);
            // along the pitch circles' tangent flanks would be further apart
            const Gear straight = {.radius_a = gear.radius_a, .radius_b = gear.radius_b};
            const Mesh control = {.gear = &straight};
            assert_true(i >= 2 || gap_of(&control, sign, turned, CENTRES[0]) > found + 5e-5);
        }
    }
}

// A motion of the gears, with a table of each kind.
static double gap_at(const Mesh *mesh, double sign, double time, Vec2 *offset, double angles[2])
{
    *offset = (Vec2){DISTANCE + 2e-4 * sin(3.0 * time), 5e-4 * cos(2.0 * time)};
    angles[0] = 0.3 * time * time + 1.1 * time;
    angles[1] = 0.2 - 0.5 * time + 0.1 * cos(time);
    return gap_of(mesh, sign, angles, *offset);
}

static Profile table_of(double size, size_t repeats)
{
    Profile table = {.count = 8, .is_signed = true, .period = 2.0 * M_PI / (double)repeats};
    Err err = {0};
    for (size_t i = 0; i < table.count; i++) {
        const double share = (double)i / (double)table.count;
        table.angles[i] = share * table.period;
        table.radii[i] = size * (sin(2.0 * M_PI * share) + 0.3 * cos(4.0 * M_PI * share));
    }
    assert_true(profile_settle(&table, &err));
    return table;
}

static void rates_are_those_of_the_gap(void **state)
{
    (void)state;
    const Profile error = table_of(2e-5, 20);
    const Profile relief = table_of(1e-5, 10);
    const double h = 3e-4;
    for (int i = 0; i < 4; i++) {
        Gear gear = gear_of(i / 2);
        gear.zero = 0.1;
        const Mesh mesh = {.gear = &gear, .error = &error, .relief = &relief};
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        const double t = 0.7;
        Vec2 offset[5];
        double angles[5][2];
        double gaps[5];
        for (int k = 0; k < 5; k++) {
            gaps[k] = gap_at(&mesh, sign, t + (k - 2) * h, &offset[k], angles[k]);
        }
        const double rate = (gaps[0] - 8.0 * gaps[1] + 8.0 * gaps[3] - gaps[4]) / (12.0 * h);
        const double second =
            (-gaps[0] + 16.0 * gaps[1] - 30.0 * gaps[2] + 16.0 * gaps[3] - gaps[4]) /
            (12.0 * h * h);
        const Vec2 velocity = {6e-4 * cos(3.0 * t), -1e-3 * sin(2.0 * t)};
        const Vec2 acceleration = {-18e-4 * sin(3.0 * t), -2e-3 * cos(2.0 * t)};
        const double omegas[2] = {0.6 * t + 1.1, -0.5 - 0.1 * sin(t)};
        const double alphas[2] = {0.6, -0.1 * cos(t)};
        const MeshFlank flank = mesh_flank(&mesh, sign, offset[2], angles[2][0], angles[2][1]);
        assert_near(mesh_rate(&flank, velocity, omegas[0], omegas[1]), rate, 1e-9);
        assert_near(mesh_rate(&flank, acceleration, alphas[0], alphas[1]) +
                        mesh_bend(&flank, velocity, omegas[0], omegas[1]),
                    second, 1e-6);
        // the force at its point on either gear has the moment that the rate has
        assert_near(vec2_cross(flank.from_b, flank.normal), -sign * flank.arms[1], 1e-15);
        assert_near(vec2_cross(vec2_add(offset[2], flank.from_b), flank.normal),
                    sign * flank.arms[0], 1e-15);
    }
}

// Near to R the spread is a sum, further off the involutes' own function.
static void the_spread_is_one_function(void **state)
{
    (void)state;
    const Gear gear = gear_of(EXTERNAL);
    const Mesh mesh = {.gear = &gear};
    const double edge = 0.1 * DISTANCE * (1.0 - cos(ALPHA));
    for (int i = 0; i < 2; i++) {
        const double apart = (i == 0 ? 1.0 : -1.0) * edge;
        const MeshFlank flank = mesh_flank(&mesh, 1.0, (Vec2){DISTANCE, 0.0}, 0.0, 0.0);
        const double inside = mesh_gap(&gear, &flank, 0.0, apart * (1.0 - 1e-12));
        const double outside = mesh_gap(&gear, &flank, 0.0, apart * (1.0 + 1e-12));
        assert_near(inside, outside, 1e-15);
        assert_near(inside / apart, sin(ALPHA), 0.1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flanks_are_as_far_apart_as_their_curves),
        cmocka_unit_test(rates_are_those_of_the_gap),
        cmocka_unit_test(the_spread_is_one_function),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

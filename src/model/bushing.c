// Finds what bushings do to their bodies.
//
// With the axes e_x, e_y, which turn with body a, the anchors A on body a and B on body b,
//     deflection  u = (e_x . (B - A), e_y . (B - A), phi_b - phi_a - phi_0)
//     rate        u' = (e_x . w, e_y . w, w_b - w_a),   w = v_B - v_a(B)
// v_a(B) the velocity of the point of body a under B: the axes turn with it. Then
//     pull k u, or by points f(u);   drag c u'
// act along the axes on body a at B, and the other way on body b: momentum is kept, and the power
// is that of the deflections alone.
//     energy  sum k u^2 / 2, or the integral of f;   power of the dampers  sum c u'^2
#include "model/bushing.h"

BushingPose bushing_pose(const Bushing *bushing, const Motion *motions)
{
    const bool is_held = bushing->body_a == LINKAGE_GROUND;
    const double angle_a = is_held ? 0.0 : motions[bushing->body_a].angle;
    const double omega_a = is_held ? 0.0 : motions[bushing->body_a].omega;
    const bool is_on_ground = bushing->body_b == LINKAGE_GROUND;
    const double angle_b = is_on_ground ? 0.0 : motions[bushing->body_b].angle;
    const double omega_b = is_on_ground ? 0.0 : motions[bushing->body_b].omega;
    const Vec2 x = vec2_rotate(angle_a + bushing->direction, (Vec2){1.0, 0.0});
    const Vec2 y = vec2_perp(x);
    const Vec2 a = linkage_point(motions, bushing->body_a, bushing->anchor_a);
    const Vec2 b = linkage_point(motions, bushing->body_b, bushing->anchor_b);
    const Vec2 apart = vec2_sub(b, a);
    const Vec2 moving =
        vec2_sub(linkage_point_velocity(motions, bushing->body_b, bushing->anchor_b),
                 linkage_point_velocity(motions, bushing->body_a, bushing->anchor_a));
    const Vec2 against = vec2_sub(moving, vec2_scale(omega_a, vec2_perp(apart)));
    return (BushingPose){
        .axes = {x, y},
        .point = b,
        .deflection = {vec2_dot(x, apart), vec2_dot(y, apart), angle_b - angle_a - bushing->angle},
        .rate = {vec2_dot(x, against), vec2_dot(y, against), omega_b - omega_a},
    };
}

const ForceCurve *bushing_curve(const Bushing *bushing, size_t row)
{
    const ForceCurve *const curves[] = {&bushing->force_x, &bushing->force_y, &bushing->torque};
    return curves[row];
}

static double stiffness_of(const Bushing *bushing, size_t row)
{
    const double rows[] = {bushing->stiffness.x, bushing->stiffness.y,
                           bushing->torsional_stiffness};
    return rows[row];
}

double bushing_damping(const Bushing *bushing, size_t row)
{
    const double rows[] = {bushing->damping.x, bushing->damping.y, bushing->torsional_damping};
    return rows[row];
}

bool bushing_damps(const Bushing *bushing)
{
    return bushing->damping.x > 0.0 || bushing->damping.y > 0.0 || bushing->torsional_damping > 0.0;
}

double bushing_pull(const Bushing *bushing, const BushingPose *pose, size_t row)
{
    const ForceCurve *curve = bushing_curve(bushing, row);
    const double deflection = pose->deflection[row];
    return curve->count > 0 ? force_curve_at(curve, deflection)
                            : stiffness_of(bushing, row) * deflection;
}

double bushing_drag(const Bushing *bushing, const BushingPose *pose, size_t row)
{
    return bushing_damping(bushing, row) * pose->rate[row];
}

double bushing_energy(const Bushing *bushing, const BushingPose *pose)
{
    double energy = 0.0;
    for (size_t row = 0; row < BUSHING_ROWS; row++) {
        const ForceCurve *curve = bushing_curve(bushing, row);
        const double deflection = pose->deflection[row];
        energy += curve->count > 0 ? force_curve_energy(curve, deflection)
                                   : 0.5 * stiffness_of(bushing, row) * deflection * deflection;
    }
    return energy;
}

double bushing_power(const Bushing *bushing, const BushingPose *pose)
{
    double power = 0.0;
    for (size_t row = 0; row < BUSHING_ROWS; row++) {
        power += bushing_drag(bushing, pose, row) * pose->rate[row];
    }
    return power;
}

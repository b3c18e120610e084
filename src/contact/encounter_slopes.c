// How does the force of a contact change with position and speed?
//
// e eccentricity, v its rate, n the normal (inwards), t = perp n, o = -n, d = |e| - clearance:
//     d' = o . v            dd = o . de,   dn = -t (t . de) / |e|,   dt = n (t . de) / |e|
//     N(d, d')              dN = N_d o . de + N_d' (o . dv + (t . v) (t . de) / |e|)
// and with friction, the letters as in contact/encounter_force.c:
//     H = mu N tanh(v_t / v_s)
//     dv_t = (n . v) (t . de) / |e| + u_b' o . de + t . dv + R du_a' - (R - |e|) du_b'
//     F = N n - H t,  moments -R H and (R - |e|) H
#include "contact/encounter_slopes.h"

#include <math.h>
#include <string.h>

enum { PLACES = 2, SPEEDS = RESPONSE_ROWS_A_JOINT, PARTS = PLACES + SPEEDS };

// A scalar's derivatives: by e, then by the rates of the joint's rows.
typedef struct Gradient {
    double of[PARTS];
} Gradient;

static Gradient along(Vec2 by_place, Vec2 by_speed)
{
    return (Gradient){{by_place.x, by_place.y, by_speed.x, by_speed.y, 0.0, 0.0}};
}

// The normal force and its gradient.
static double find_normal(const EncounterJoint *joint, const PinHole *pose, Vec2 velocity,
                          double from_depth, Gradient *gradient)
{
    const ForceLaw *law = &joint->law;
    const Vec2 outward = vec2_scale(-1.0, pose->normal);
    const Vec2 tangent = vec2_perp(pose->normal);
    const double depth = fmax(pose->penetration, from_depth);
    const double below = pose->penetration - depth;
    const double elastic = force_law_elastic(law, depth);
    const double tangent_stiffness = force_law_tangent(law, depth);
    const double floored = fmax(joint->impact_speed, law->impact_speed_floor);
    const double rise = 1.0 + law->hysteresis * pose->approach_speed / floored;
    const double by_depth = tangent_stiffness * (below < 0.0 ? 1.0 : rise);
    const double by_rate = law->hysteresis * elastic / floored + law->viscous;
    const double turning = by_rate * vec2_dot(tangent, velocity) / pose->eccentricity_size;
    *gradient = along(vec2_add(vec2_scale(by_depth, outward), vec2_scale(turning, tangent)),
                      vec2_scale(by_rate, outward));
    return elastic * rise + law->viscous * pose->approach_speed + tangent_stiffness * below;
}

// The derivatives of x g, with those of g.
static Gradient product_rule(double x, const Gradient *dx, double g, const Gradient *dg)
{
    Gradient sum;
    for (size_t k = 0; k < PARTS; k++) {
        sum.of[k] = x * dg->of[k] + g * dx->of[k];
    }
    return sum;
}

static void write_slopes(EncounterSlopes *slopes, size_t row, double force,
                         const Gradient *gradient)
{
    slopes->force[row] = force;
    memcpy(slopes->by_place[row], gradient->of, PLACES * sizeof *gradient->of);
    memcpy(slopes->by_speed[row], gradient->of + PLACES, SPEEDS * sizeof *gradient->of);
}

// Friction's force along the tangent, taken from it, and its gradient.
static double find_friction(const Encounter *encounter, const EncounterJoint *joint,
                            const PinHole *pose, const double *speeds, double normal,
                            const Gradient *by_normal, Gradient *gradient)
{
    const Vec2 tangent = vec2_perp(pose->normal);
    const Vec2 velocity = {speeds[0], speeds[1]};
    const double hole_arm = joint->hole_radius;
    const double pin_arm = hole_arm - pose->eccentricity_size;
    const double sliding = vec2_dot(tangent, velocity) + hole_arm * speeds[2] - pin_arm * speeds[3];
    const double turning = vec2_dot(pose->normal, velocity) / pose->eccentricity_size;
    Gradient by_sliding = along(
        vec2_add(vec2_scale(turning, tangent), vec2_scale(-speeds[3], pose->normal)), tangent);
    by_sliding.of[PLACES + 2] = hole_arm;
    by_sliding.of[PLACES + 3] = -pin_arm;
    const double share = tanh(sliding / encounter->friction_speed);
    const double slope = (1.0 - share * share) / encounter->friction_speed;
    for (size_t k = 0; k < PARTS; k++) {
        gradient->of[k] =
            encounter->friction * (share * by_normal->of[k] + normal * slope * by_sliding.of[k]);
    }
    return encounter->friction * normal * share;
}

void encounter_slopes_find(const Encounter *encounter, size_t number, double time_s,
                           const double *impulse, const double *moment, double from_depth,
                           EncounterSlopes *slopes)
{
    const EncounterJoint *joint = &encounter->joints[number];
    const size_t rows = encounter->rows_a_joint;
    const PinHole pose = encounter_force_pose(encounter, number, time_s, impulse, moment);
    memset(slopes, 0, sizeof *slopes);
    if (!joint->is_touching || (pose.penetration <= 0.0 && from_depth == 0.0)) {
        return;
    }
    double speeds[SPEEDS] = {0.0};
    for (size_t i = 0; i < rows; i++) {
        speeds[i] = encounter_force_row_speed(encounter, number * rows + i, time_s, impulse);
    }
    Gradient by_normal;
    const double normal =
        find_normal(joint, &pose, (Vec2){speeds[0], speeds[1]}, from_depth, &by_normal);
    if (normal < 0.0 && from_depth == 0.0) {
        return;
    }
    // the directions turn with the pin's way round the hole
    const Vec2 tangent = vec2_perp(pose.normal);
    const Vec2 round = vec2_scale(1.0 / pose.eccentricity_size, tangent);
    const Vec2 still = {0.0, 0.0};
    const double n[2] = {pose.normal.x, pose.normal.y};
    const double t[2] = {tangent.x, tangent.y};
    Gradient by_friction = along(still, still);
    // a wall that pulls rubs on nothing
    const double held =
        encounter->friction > 0.0 && normal > 0.0
            ? find_friction(encounter, joint, &pose, speeds, normal, &by_normal, &by_friction)
            : 0.0;
    for (size_t i = 0; i < 2; i++) {
        const Gradient normal_turns = along(vec2_scale(-t[i], round), still);
        const Gradient tangent_turns = along(vec2_scale(n[i], round), still);
        Gradient row = product_rule(normal, &by_normal, n[i], &normal_turns);
        const Gradient taken = product_rule(held, &by_friction, t[i], &tangent_turns);
        for (size_t k = 0; k < PARTS; k++) {
            row.of[k] -= taken.of[k];
        }
        write_slopes(slopes, i, normal * n[i] - held * t[i], &row);
    }
    if (rows == RESPONSE_ROWS_A_JOINT) {
        const double arm = joint->hole_radius;
        const double pin_arm = arm - pose.eccentricity_size;
        const Gradient fixed = along(still, still);
        const Gradient shortens = along(pose.normal, still); // of R - |e|
        const Gradient on_hole = product_rule(held, &by_friction, -arm, &fixed);
        const Gradient on_pin = product_rule(held, &by_friction, pin_arm, &shortens);
        write_slopes(slopes, 2, -arm * held, &on_hole);
        write_slopes(slopes, 3, pin_arm * held, &on_pin);
    }
}

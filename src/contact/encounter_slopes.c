// How does the force of a contact change with position and speed?
//
// e eccentricity, v its rate, n the normal (inwards), t = perp n, o = -n, d = |e| - clearance:
//     d' = o . v            dd = o . de,   dn = -t (t . de) / |e|,   dt = n (t . de) / |e|
//     N(d, d')              dN = N_d o . de + N_d' (o . dv + (t . v) (t . de) / |e|)
// of two discs |e| is -|e|, at a line infinite: neither n nor t turns. With friction, the letters
// as in contact/encounter_force.c:
//     H = mu N tanh(v_t / v_s)
//     dv_t = (n . v) (t . de) / |e| + u_b' o . de + t . dv + R du_a' - (R - |e|) du_b'
//     F = N n - H t,  moments -R H and (R - |e|) H
// In space, with s = |(v_t, v_z)| and phi = tanh(s / v_s) / s,
//     H_t = mu N phi v_t,  H_z = mu N phi v_z
//     dv_z = du_z' + (R - |e|) t . dw_b - R t . dw_a
//            + ((R - |e|) n . w_b - R n . w_a) (t . de) / |e| - t . w_b o . de
#include "contact/encounter_slopes.h"

#include "contact/encounter_friction.h"

#include <math.h>
#include <string.h>

enum { PLACES = 2, SPEEDS = ENCOUNTER_ROWS_MOST, PARTS = PLACES + SPEEDS };

// A scalar's derivatives: by e, then by the rates of the joint's rows.
typedef struct Gradient {
    double of[PARTS];
} Gradient;

static Gradient along(Vec2 by_place, Vec2 by_speed)
{
    return (Gradient){{by_place.x, by_place.y, by_speed.x, by_speed.y}};
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

// Friction's force, taken from the pin: along the tangent, and along its axis; with gradients.
typedef struct Held {
    double round;
    double axial;
    Gradient by_round;
    Gradient by_axial;
} Held;

// How fast the pin slides along its axis, and how that changes.
static double find_axial(const EncounterJoint *joint, const PinHole *pose, const double *speeds,
                         Gradient *gradient)
{
    const double hole_arm = joint->hole_radius;
    const double pin_arm = hole_arm - pose->eccentricity_size;
    const Vec2 tangent = vec2_perp(pose->normal);
    const Vec2 hole = {speeds[ENCOUNTER_ROW_HOLE], speeds[ENCOUNTER_ROW_HOLE + 1]};
    const Vec2 pin = {speeds[ENCOUNTER_ROW_PIN], speeds[ENCOUNTER_ROW_PIN + 1]};
    const Vec2 arms = vec2_sub(vec2_scale(pin_arm, pin), vec2_scale(hole_arm, hole));
    const double turning = vec2_dot(pose->normal, arms) / pose->eccentricity_size;
    *gradient = along(
        vec2_add(vec2_scale(turning, tangent), vec2_scale(vec2_dot(tangent, pin), pose->normal)),
        (Vec2){0.0, 0.0});
    double *by_speed = gradient->of + PLACES;
    by_speed[ENCOUNTER_ROW_AXIAL] = 1.0;
    by_speed[ENCOUNTER_ROW_HOLE] = -hole_arm * tangent.x;
    by_speed[ENCOUNTER_ROW_HOLE + 1] = -hole_arm * tangent.y;
    by_speed[ENCOUNTER_ROW_PIN] = pin_arm * tangent.x;
    by_speed[ENCOUNTER_ROW_PIN + 1] = pin_arm * tangent.y;
    return speeds[ENCOUNTER_ROW_AXIAL] + vec2_dot(tangent, arms);
}

// Friction against a sliding that has two directions.
static void find_both(const EncounterJoint *joint, double round, const Gradient *by_round,
                      double axial, const Gradient *by_axial, double normal,
                      const Gradient *by_normal, Held *held)
{
    const EncounterGrip grip =
        encounter_friction_grip(hypot(round, axial), joint->law.friction_speed);
    const double share = grip.share;
    for (size_t k = 0; k < PARTS; k++) {
        const double growth = grip.bend * (round * by_round->of[k] + axial * by_axial->of[k]);
        const double along_round = share * by_round->of[k] + growth * round;
        const double along_axis = share * by_axial->of[k] + growth * axial;
        held->by_round.of[k] =
            joint->law.friction * (share * round * by_normal->of[k] + normal * along_round);
        held->by_axial.of[k] =
            joint->law.friction * (share * axial * by_normal->of[k] + normal * along_axis);
    }
    held->round = joint->law.friction * normal * share * round;
    held->axial = joint->law.friction * normal * share * axial;
}

// How fast the pin slides round its hole, or a circle along its line, and how that changes.
static double find_round(const EncounterJoint *joint, const PinHole *pose, const double *speeds,
                         Gradient *gradient)
{
    const Vec2 tangent = vec2_perp(pose->normal);
    const Vec2 velocity = {speeds[0], speeds[1]};
    if (joint->shape == TOUCH_LINE) {
        *gradient = along((Vec2){0.0, 0.0}, tangent);
        return speeds[1];
    }
    const double hole_arm = joint->hole_radius;
    const double pin_arm = hole_arm - pose->eccentricity_size;
    const double turning = vec2_dot(pose->normal, velocity) / pose->eccentricity_size;
    *gradient = along(vec2_add(vec2_scale(turning, tangent), vec2_scale(-speeds[3], pose->normal)),
                      tangent);
    gradient->of[PLACES + 2] = hole_arm;
    gradient->of[PLACES + 3] = -pin_arm;
    return vec2_dot(tangent, velocity) + hole_arm * speeds[2] - pin_arm * speeds[3];
}

static void find_friction(const EncounterJoint *joint, const PinHole *pose, const double *speeds,
                          double normal, const Gradient *by_normal, Held *held)
{
    Gradient by_sliding;
    const double sliding = find_round(joint, pose, speeds, &by_sliding);
    if (joint->row_count == ENCOUNTER_ROWS_MOST) {
        Gradient by_axial;
        const double axial = find_axial(joint, pose, speeds, &by_axial);
        find_both(joint, sliding, &by_sliding, axial, &by_axial, normal, by_normal, held);
        return;
    }
    const EncounterHold hold = encounter_friction_hold(sliding, joint->law.friction_speed);
    for (size_t k = 0; k < PARTS; k++) {
        held->by_round.of[k] = joint->law.friction * (hold.held * by_normal->of[k] +
                                                      normal * hold.slope * by_sliding.of[k]);
    }
    held->round = joint->law.friction * normal * hold.held;
}

// The rows of the bodies' turns about the pin's axis.
static void write_turns(const EncounterJoint *joint, const PinHole *pose, const Held *held,
                        EncounterSlopes *slopes)
{
    const Vec2 still = {0.0, 0.0};
    const double arm = joint->hole_radius;
    const double pin_arm = arm - pose->eccentricity_size;
    const Gradient fixed = along(still, still);
    const Gradient shortens = along(pose->normal, still); // of R - |e|
    const Gradient on_hole = product_rule(held->round, &held->by_round, -arm, &fixed);
    const Gradient on_pin = product_rule(held->round, &held->by_round, pin_arm, &shortens);
    write_slopes(slopes, ENCOUNTER_ROW_TURN, -arm * held->round, &on_hole);
    write_slopes(slopes, ENCOUNTER_ROW_TURN + 1, pin_arm * held->round, &on_pin);
}

// The rows that friction along the axis acts in.
static void write_axial(const EncounterJoint *joint, const PinHole *pose, const Held *held,
                        EncounterSlopes *slopes)
{
    const Vec2 still = {0.0, 0.0};
    const Vec2 tangent = vec2_perp(pose->normal);
    const Vec2 round = vec2_scale(1.0 / pose->eccentricity_size, tangent);
    const double n[2] = {pose->normal.x, pose->normal.y};
    const double t[2] = {tangent.x, tangent.y};
    const double arm = joint->hole_radius;
    const double pin_arm = arm - pose->eccentricity_size;
    const Gradient fixed = along(still, still);
    const Gradient lengthens = along(vec2_scale(-1.0, pose->normal), still); // of |e| - R
    const Gradient on_axis = product_rule(held->axial, &held->by_axial, -1.0, &fixed);
    write_slopes(slopes, ENCOUNTER_ROW_AXIAL, -held->axial, &on_axis);
    for (size_t i = 0; i < 2; i++) {
        const Gradient turns = along(vec2_scale(n[i], round), still);
        const double part = held->axial * t[i];
        const Gradient by_part = product_rule(held->axial, &held->by_axial, t[i], &turns);
        const Gradient on_hole = product_rule(part, &by_part, arm, &fixed);
        const Gradient on_pin = product_rule(part, &by_part, -pin_arm, &lengthens);
        write_slopes(slopes, ENCOUNTER_ROW_HOLE + i, arm * part, &on_hole);
        write_slopes(slopes, ENCOUNTER_ROW_PIN + i, -pin_arm * part, &on_pin);
    }
}

void encounter_slopes_find(const Encounter *encounter, size_t number, double time_s,
                           const double *impulse, const double *moment, double from_depth,
                           EncounterSlopes *slopes)
{
    const EncounterJoint *joint = &encounter->joints[number];
    const PinHole pose = encounter_motion_pose(encounter, number, time_s, impulse, moment);
    memset(slopes, 0, sizeof *slopes);
    if (!joint->is_touching || (pose.penetration <= 0.0 && from_depth == 0.0)) {
        return;
    }
    double speeds[SPEEDS] = {0.0};
    for (size_t i = 0; i < joint->row_count; i++) {
        speeds[i] =
            encounter_motion_speed(encounter, joint->first_row + i, time_s, impulse, moment);
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
    Held held = {.round = 0.0};
    // a wall that pulls rubs on nothing
    if (joint->has_friction && normal > 0.0) {
        find_friction(joint, &pose, speeds, normal, &by_normal, &held);
    }
    for (size_t i = 0; i < 2; i++) {
        const Gradient normal_turns = along(vec2_scale(-t[i], round), still);
        const Gradient tangent_turns = along(vec2_scale(n[i], round), still);
        Gradient row = product_rule(normal, &by_normal, n[i], &normal_turns);
        const Gradient taken = product_rule(held.round, &held.by_round, t[i], &tangent_turns);
        for (size_t k = 0; k < PARTS; k++) {
            row.of[k] -= taken.of[k];
        }
        write_slopes(slopes, i, normal * n[i] - held.round * t[i], &row);
    }
    if (joint->row_count > ENCOUNTER_ROWS_PLAIN) {
        write_turns(joint, &pose, &held, slopes);
    }
    if (joint->row_count == ENCOUNTER_ROWS_MOST) {
        write_axial(joint, &pose, &held, slopes);
    }
}

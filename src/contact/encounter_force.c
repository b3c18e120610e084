// With which forces do pins and holes act on the rows of their relative motion?
//
// Normal force by the law (contact/force_law.h). Friction, as in reference/plane/dynamics.c:
// mu N tanh(v_t / v_s) against the sliding speed
//     v_t = t . u_e' + R u_a' - (R - |e|) u_b',   t the normal turned by a quarter turn,
// R the hole's radius, e eccentricity, u_a', u_b' the turning of the hole's and the pin's body
// about the pin's axis. Two discs outside each other are a hole of negative radius, and |e| is then
// -|e|. At a line normal and tangent are the rows. In space the pin slides along the axis too, with
// w the turning about x and y,
//     v_z = u_z' - R t . w_a + (R - |e|) t . w_b
// and friction is mu N tanh(s / v_s) against the direction of (v_t, v_z), s its size.
#include "contact/encounter_force.h"

#include "contact/encounter_friction.h"

#include <math.h>
#include <string.h>

// rows of an encounter from which on all are worked out together
enum { WIDE = 8 };

// The pose of a joint at a point from rows that were found together.
static void place_by_rows(const Encounter *encounter, size_t joint, EncounterPlaced *placed)
{
    const size_t row = encounter->joints[joint].first_row;
    const EncounterWork *work = encounter->work;
    const double position[2] = {work->positions[row], work->positions[row + 1]};
    placed->speed[0] = work->speeds[row];
    placed->speed[1] = work->speeds[row + 1];
    placed->pose = encounter_motion_pose_of(encounter, joint, position, placed->speed);
    placed->is_known = true;
}

// How fast a pin slides round its hole.
static double sliding_round(const double *speed, Vec2 tangent, double hole_arm, double pin_arm)
{
    return tangent.x * speed[0] + tangent.y * speed[1] + hole_arm * speed[ENCOUNTER_ROW_TURN] -
           pin_arm * speed[ENCOUNTER_ROW_TURN + 1];
}

// How fast a pin slides along its axis.
static double sliding_along(const double *speed, Vec2 tangent, double hole_arm, double pin_arm)
{
    const double *hole = speed + ENCOUNTER_ROW_HOLE;
    const double *pin = speed + ENCOUNTER_ROW_PIN;
    return speed[ENCOUNTER_ROW_AXIAL] - hole_arm * (tangent.x * hole[0] + tangent.y * hole[1]) +
           pin_arm * (tangent.x * pin[0] + tangent.y * pin[1]);
}

// Adds friction to a joint's rows that press with a normal force; returns the power it takes, W.
static double add_friction(const Encounter *encounter, size_t joint, const double *speed,
                           const PinHole *pose, double normal, double *force)
{
    const EncounterJoint *of = &encounter->joints[joint];
    const size_t row = of->first_row;
    if (of->shape == TOUCH_LINE) {
        const double taken = of->law.friction * normal *
                             encounter_friction_hold(speed[1], of->law.friction_speed).held;
        force[row + 1] -= taken;
        return taken * speed[1];
    }
    const double hole_arm = of->hole_radius;
    const double pin_arm = hole_arm - pose->eccentricity_size;
    const Vec2 tangent = vec2_perp(pose->normal);
    const double sliding = sliding_round(speed, tangent, hole_arm, pin_arm);
    double held;
    double power;
    if (of->row_count < ENCOUNTER_ROWS_MOST) {
        held = of->law.friction * normal *
               encounter_friction_hold(sliding, of->law.friction_speed).held;
        power = held * sliding;
    } else {
        const double axial = sliding_along(speed, tangent, hole_arm, pin_arm);
        const double size = hypot(sliding, axial);
        const double grip =
            of->law.friction * normal * encounter_friction_grip(size, of->law.friction_speed).share;
        const double along = grip * axial;
        held = grip * sliding;
        power = grip * size * size;
        force[row + ENCOUNTER_ROW_AXIAL] = -along;
        force[row + ENCOUNTER_ROW_HOLE] = hole_arm * along * tangent.x;
        force[row + ENCOUNTER_ROW_HOLE + 1] = hole_arm * along * tangent.y;
        force[row + ENCOUNTER_ROW_PIN] = -pin_arm * along * tangent.x;
        force[row + ENCOUNTER_ROW_PIN + 1] = -pin_arm * along * tangent.y;
    }
    force[row] -= held * tangent.x;
    force[row + 1] -= held * tangent.y;
    force[row + ENCOUNTER_ROW_TURN] = -hole_arm * held;
    force[row + ENCOUNTER_ROW_TURN + 1] = pin_arm * held;
    return power;
}

// What presses along the normal of a joint that touches. Where a contact has just begun its depth
// is zero but for rounding, of either sign, and a viscous damper presses hardest.
static double pressing(const EncounterJoint *joint, const EncounterTouch *touch)
{
    const double rate = touch->pose.approach_speed;
    const double speed = fmax(joint->impact_speed, joint->law.impact_speed_floor);
    const double total =
        touch->elastic * (1.0 + joint->law.hysteresis * rate / speed) + joint->law.viscous * rate;
    return total < 0.0 ? 0.0 : total; // a comparison that lets NaN through
}

// How a joint is at a point; of its rows beyond the first two only where there is friction. Many
// rows have been found together.
static void find_touch(const Encounter *encounter, const EncounterPoint *point, size_t joint,
                       bool is_wide, EncounterTouch *touch)
{
    const EncounterJoint *of = &encounter->joints[joint];
    EncounterPlaced *placed = &point->placed[joint];
    if (is_wide) {
        place_by_rows(encounter, joint, placed);
    }
    touch->pose = *encounter_point_pose(encounter, point, joint);
    touch->speed[0] = placed->speed[0];
    touch->speed[1] = placed->speed[1];
    for (size_t i = ENCOUNTER_ROWS_PLAIN; i < of->row_count; i++) {
        const size_t row = of->first_row + i;
        touch->speed[i] = is_wide ? encounter->work->speeds[row]
                                  : encounter_motion_speed(encounter, row, point->time_s,
                                                           point->impulse, point->moment);
    }
    force_law_both(&of->law, touch->pose.penetration, &touch->elastic, &touch->tangent);
}

void encounter_force_find_touching(Encounter *encounter, const EncounterPoint *point, double *force,
                                   double powers[2], EncounterTouch *touching)
{
    const bool is_wide = encounter->row_count >= WIDE;
    bool is_any = false;
    powers[0] = powers[1] = 0.0;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const EncounterJoint *joint = &encounter->joints[i];
        double *own = force + joint->first_row;
        if (!joint->is_touching) {
            memset(own, 0, joint->row_count * sizeof *own);
            continue;
        }
        if (!is_any && is_wide) {
            encounter_motion_all(encounter, point->time_s, point->impulse, point->moment,
                                 encounter->work->positions, encounter->work->speeds);
        }
        is_any = true;
        EncounterTouch *touch = &touching[i];
        find_touch(encounter, point, i, is_wide, touch);
        const PinHole *pose = &touch->pose;
        const double normal = pressing(joint, touch);
        own[0] = normal * pose->normal.x;
        own[1] = normal * pose->normal.y;
        powers[0] += (normal - touch->elastic) * pose->approach_speed;
        if (joint->has_friction) {
            powers[1] += add_friction(encounter, i, touch->speed, pose, normal, force);
        }
    }
    encounter->evaluations += is_any ? 1 : 0;
    encounter_count_work(encounter);
}

void encounter_force_find(Encounter *encounter, double time_s, const double *impulse,
                          const double *moment, double *force, double powers[2])
{
    EncounterPoint *point = &encounter->work->last; // of explicit steps, which ask for no forces
    encounter_point_begin(encounter, point, time_s);
    memcpy(point->impulse, impulse, encounter->row_count * sizeof *impulse);
    memcpy(point->moment, moment, 2 * encounter->row_count * sizeof *moment);
    encounter_force_find_touching(encounter, point, force, powers, encounter->work->touching);
}

// By how much the places that can press together with one move it along its normal, 1/kg; of a
// block only the corners that touch, for most of its impacts are of one.
static double mobility_between(const Encounter *encounter, const EncounterJoint *of, Vec2 normal)
{
    double sum = 0.0;
    for (int k = of->siblings[0]; k <= of->siblings[1]; k++) {
        const double *other = encounter_mobility(encounter, of->first_row, of[k].first_row);
        const double *below = other + encounter->pitch;
        const double between = normal.x * (other[0] * normal.x + other[1] * normal.y) +
                               normal.y * (below[0] * normal.x + below[1] * normal.y);
        const bool presses = of[k].is_touching || of[k].shape != TOUCH_LINE;
        sum += k != 0 && presses ? fabs(between) : 0.0;
    }
    return sum;
}

// Mobility along the normal of a joint, 1/kg. Places that press together move each other.
static inline double normal_mobility(const Encounter *encounter, size_t joint, Vec2 normal)
{
    const EncounterJoint *of = &encounter->joints[joint];
    const double *first = encounter_mobility(encounter, of->first_row, of->first_row);
    const double own = normal.x * (first[0] * normal.x + 2.0 * first[1] * normal.y) +
                       normal.y * first[encounter->pitch + 1] * normal.y;
    return of->siblings[0] == of->siblings[1] ? own : own + mobility_between(encounter, of, normal);
}

double encounter_force_frequency(const Encounter *encounter, size_t joint, Vec2 normal,
                                 double depth)
{
    const double stiffness = force_law_tangent(&encounter->joints[joint].law, depth);
    return sqrt(normal_mobility(encounter, joint, normal) * stiffness);
}

double encounter_force_decay(const Encounter *encounter, size_t joint, Vec2 normal, double depth)
{
    const EncounterJoint *of = &encounter->joints[joint];
    return normal_mobility(encounter, joint, normal) *
           force_law_damping(&of->law, depth, of->impact_speed);
}

double encounter_force_friction_time(const Encounter *encounter, size_t joint, const double *force)
{
    const size_t row = encounter->joints[joint].first_row;
    const double arm = encounter->joints[joint].hole_radius;
    double mobility = 0.0;
    for (size_t k = 0; k < encounter->joints[joint].row_count; k++) {
        const double diagonal = *encounter_mobility(encounter, row + k, row + k);
        const bool is_turn = k >= ENCOUNTER_ROWS_PLAIN && k != ENCOUNTER_ROW_AXIAL;
        mobility += is_turn ? arm * arm * diagonal : diagonal;
    }
    const double held = encounter->joints[joint].law.friction * hypot(force[row], force[row + 1]);
    return held > 0.0 ? encounter->joints[joint].law.friction_speed / (held * mobility) : INFINITY;
}

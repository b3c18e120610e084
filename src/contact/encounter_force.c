// With which forces do pins and holes act on the rows of their relative motion?
//
// Normal force by the law (contact/force_law.h). Friction, as in reference/dynamics_contact.c:
// mu N tanh(v_t / v_s) against the sliding speed
//     v_t = t . u_e' + R u_a' - (R - |e|) u_b',   t the normal turned by a quarter turn,
// R the hole's radius, e eccentricity, u_a', u_b' the turning of the hole's and the pin's body
// about the pin's axis. Two discs outside each other are a hole of negative radius, and |e| is then
// -|e|. At a line normal and tangent are the rows. In space the pin slides along the axis too, with
// w the turning about x and y,
//     v_z = u_z' - R t . w_a + (R - |e|) t . w_b
// and friction is mu N tanh(s / v_s) against the direction of (v_t, v_z), s its size.
#include "contact/encounter_force.h"

#include "contact/encounter_drift.h"
#include "contact/encounter_friction.h"

#include <math.h>
#include <string.h>

// rows of an encounter from which on all are worked out together
enum { WIDE = 8 };

// Where a row is and how fast it goes, from the impulses in a span of so many rows.
static inline double row_motion_by(const Encounter *encounter, EncounterSpan span, size_t rows,
                                   size_t row, double time_s, const double *impulse,
                                   const double *moment, double *position)
{
    const double *mobility = encounter_mobility(encounter, row, 0);
    double speed = encounter_free_speed(encounter, row, time_s);
    double place = encounter_free_position(encounter, row, time_s);
    for (size_t k = span.first; k < span.end; k++) {
        place += mobility[k] * moment[k];
        speed += mobility[k] * impulse[k];
    }
    if (encounter->drift != NULL) {
        encounter_drift_add(encounter, rows, row, time_s, impulse, moment, &speed, &place);
    }
    *position = place;
    return speed;
}

// Where a row is and how fast it goes, from the impulses so far. One pin without friction is what
// most linkages have; its loops are unrolled.
static inline double row_motion(const Encounter *encounter, size_t row, double time_s,
                                const double *impulse, const double *moment, double *position)
{
    const size_t rows = encounter->row_count;
    if (rows == ENCOUNTER_ROWS_PLAIN) {
        return row_motion_by(encounter, (EncounterSpan){0, ENCOUNTER_ROWS_PLAIN},
                             ENCOUNTER_ROWS_PLAIN, row, time_s, impulse, moment, position);
    }
    return row_motion_by(encounter, encounter_span(encounter, row), rows, row, time_s, impulse,
                         moment, position);
}

double encounter_force_row_speed(const Encounter *encounter, size_t row, double time_s,
                                 const double *impulse, const double *moment)
{
    double position;
    return row_motion(encounter, row, time_s, impulse, moment, &position);
}

double encounter_force_row_acceleration(const Encounter *encounter, size_t row, double time_s,
                                        const double *impulse, const double *force)
{
    const double *mobility = encounter_mobility(encounter, row, 0);
    const EncounterSpan span = encounter_span(encounter, row);
    double acceleration = encounter_free_rate(encounter, row, time_s);
    for (size_t k = span.first; k < span.end; k++) {
        acceleration += mobility[k] * force[k];
    }
    if (encounter->drift != NULL) {
        acceleration += encounter_drift_acceleration(encounter, row, time_s, impulse, force);
    }
    return acceleration;
}

// What goes on along the line changes nothing.
static PinHole line_pose(double gap, double rate)
{
    return (PinHole){
        .eccentricity = {gap, 0.0},
        .eccentricity_size = INFINITY,
        .gap = gap,
        .penetration = -gap,
        .has_normal = true,
        .normal = {1.0, 0.0},
        .approach_speed = -rate,
    };
}

static PinHole disc_pose(Vec2 position, Vec2 speed, double clearance)
{
    PinHole pose = pin_hole_pose((Vec2){0.0, 0.0}, position, speed, -clearance);
    pose.gap = -pose.gap;
    pose.penetration = -pose.gap;
    pose.eccentricity_size = -pose.eccentricity_size;
    if (pose.has_normal) {
        pose.normal = vec2_scale(-1.0, pose.normal);
        pose.approach_speed = -pose.approach_speed;
    }
    return pose;
}

// Of all shapes but the one that has to be fast.
static PinHole other_pose(const EncounterJoint *joint, const double position[2],
                          const double speed[2])
{
    return joint->shape == TOUCH_LINE
               ? line_pose(position[0], speed[0])
               : disc_pose((Vec2){position[0], position[1]}, (Vec2){speed[0], speed[1]},
                           joint->radial_clearance);
}

static inline PinHole pose_of(const Encounter *encounter, size_t joint, const double position[2],
                              const double speed[2])
{
    const EncounterJoint *of = &encounter->joints[joint];
    return of->shape == TOUCH_HOLE
               ? pin_hole_pose((Vec2){0.0, 0.0}, (Vec2){position[0], position[1]},
                               (Vec2){speed[0], speed[1]}, of->radial_clearance)
               : other_pose(of, position, speed);
}

// The pose of a joint, and how fast its first two rows go.
static PinHole find_pose(const Encounter *encounter, size_t joint, double time_s,
                         const double *impulse, const double *moment, double speed[2])
{
    const size_t row = encounter->joints[joint].first_row;
    double position[2];
    speed[0] = row_motion(encounter, row, time_s, impulse, moment, &position[0]);
    speed[1] = row_motion(encounter, row + 1, time_s, impulse, moment, &position[1]);
    return pose_of(encounter, joint, position, speed);
}

PinHole encounter_force_pose(const Encounter *encounter, size_t joint, double time_s,
                             const double *impulse, const double *moment)
{
    double speed[2];
    if (encounter->joints[joint].shape == TOUCH_LINE) {
        double gap;
        const size_t row = encounter->joints[joint].first_row;
        speed[0] = row_motion(encounter, row, time_s, impulse, moment, &gap);
        return line_pose(gap, speed[0]);
    }
    return find_pose(encounter, joint, time_s, impulse, moment, speed);
}

void encounter_point_begin(const Encounter *encounter, EncounterPoint *point, double time_s)
{
    point->time_s = time_s;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        point->placed[i].is_known = false;
    }
}

const PinHole *encounter_point_pose(const Encounter *encounter, const EncounterPoint *point,
                                    size_t joint)
{
    EncounterPlaced *placed = &point->placed[joint];
    if (!placed->is_known) {
        placed->pose = find_pose(encounter, joint, point->time_s, point->impulse, point->moment,
                                 placed->speed);
        placed->is_known = true;
    }
    return &placed->pose;
}

PinHole encounter_force_flight(const Encounter *encounter, size_t joint, double time_s,
                               const double moved[2], const double speeds[2])
{
    const size_t row = encounter->joints[joint].first_row;
    double position[2];
    double speed[2];
    for (size_t i = 0; i < 2; i++) {
        speed[i] = encounter->speed[row + i] + time_s * encounter->free[row + i] + speeds[i];
        position[i] =
            encounter->position[row + i] + moved[i] +
            time_s * (encounter->speed[row + i] + 0.5 * time_s * encounter->free[row + i]);
    }
    return pose_of(encounter, joint, position, speed);
}

// All rows at once: the same sums in the same order, but for rows side by side, which the compiler
// turns into vectors. The mobility is symmetric.
static void find_all_rows(const Encounter *encounter, double time_s, const double *impulse,
                          const double *moment, double *positions, double *speeds)
{
    const size_t width = encounter->row_count;
    for (size_t i = 0; i < width; i++) {
        speeds[i] = encounter->speed[i] + time_s * encounter->free[i];
        positions[i] = encounter->position[i] +
                       time_s * (encounter->speed[i] + 0.5 * time_s * encounter->free[i]);
    }
    if (encounter->input != NULL) {
        const EncounterAdded *added = encounter_input_at(encounter, time_s);
        for (size_t i = 0; i < width; i++) {
            speeds[i] += added->speed[i];
            positions[i] += added->position[i];
        }
    }
    if (encounter->drift != NULL) {
        encounter_drift_bend_all(encounter, time_s, positions, speeds);
    }
    for (size_t k = 0; k < width; k++) {
        const double *mobility = encounter_mobility(encounter, k, 0);
        const EncounterSpan span = encounter_span(encounter, k);
        const double pushed = impulse[k];
        const double moved = moment[k];
        // rows of a joint that has not touched yet
        if (pushed == 0.0 && moved == 0.0) {
            continue;
        }
        for (size_t i = span.first; i < span.end; i++) {
            speeds[i] += mobility[i] * pushed;
            positions[i] += mobility[i] * moved;
        }
        if (encounter->drift != NULL) {
            encounter_drift_add_all(encounter, k, time_s, impulse, moment, positions, speeds);
        }
    }
}

// The pose of a joint at a point from rows that were found together.
static void place_by_rows(const Encounter *encounter, size_t joint, EncounterPlaced *placed)
{
    const size_t row = encounter->joints[joint].first_row;
    const EncounterWork *work = encounter->work;
    const double position[2] = {work->positions[row], work->positions[row + 1]};
    placed->speed[0] = work->speeds[row];
    placed->speed[1] = work->speeds[row + 1];
    placed->pose = pose_of(encounter, joint, position, placed->speed);
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
        const double taken =
            of->friction * normal * encounter_friction_hold(speed[1], of->friction_speed).held;
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
        held = of->friction * normal * encounter_friction_hold(sliding, of->friction_speed).held;
        power = held * sliding;
    } else {
        const double axial = sliding_along(speed, tangent, hole_arm, pin_arm);
        const double size = hypot(sliding, axial);
        const double grip =
            of->friction * normal * encounter_friction_grip(size, of->friction_speed).share;
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
                                  : encounter_force_row_speed(encounter, row, point->time_s,
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
            find_all_rows(encounter, point->time_s, point->impulse, point->moment,
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
    const double held = encounter->joints[joint].friction * hypot(force[row], force[row + 1]);
    return held > 0.0 ? encounter->joints[joint].friction_speed / (held * mobility) : INFINITY;
}

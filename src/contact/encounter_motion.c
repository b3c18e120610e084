// Where are the rows of an encounter, how fast do they go, and what does that make of its joints?
//
// What impulses P, their integrals Q and the free motion make of a row is in
// contact/encounter_run.c.
#include "contact/encounter_motion.h"

#include "contact/encounter_drift.h"

#include <math.h>

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

double encounter_motion_speed(const Encounter *encounter, size_t row, double time_s,
                              const double *impulse, const double *moment)
{
    double position;
    return row_motion(encounter, row, time_s, impulse, moment, &position);
}

// The acceleration of a row under the forces in a span of so many rows.
static inline double row_acceleration_by(const Encounter *encounter, EncounterSpan span,
                                         size_t rows, size_t row, double time_s,
                                         const double *impulse, const double *force)
{
    const double *mobility = encounter_mobility(encounter, row, 0);
    double acceleration = encounter_free_rate(encounter, row, time_s);
    for (size_t k = span.first; k < span.end; k++) {
        acceleration += mobility[k] * force[k];
    }
    if (encounter->drift != NULL) {
        acceleration += encounter_drift_acceleration(encounter, rows, row, time_s, impulse, force);
    }
    return acceleration;
}

double encounter_motion_acceleration(const Encounter *encounter, size_t row, double time_s,
                                     const double *impulse, const double *force)
{
    const size_t rows = encounter->row_count;
    return rows == ENCOUNTER_ROWS_PLAIN
               ? row_acceleration_by(encounter, (EncounterSpan){0, ENCOUNTER_ROWS_PLAIN},
                                     ENCOUNTER_ROWS_PLAIN, row, time_s, impulse, force)
               : row_acceleration_by(encounter, encounter_span(encounter, row), rows, row, time_s,
                                     impulse, force);
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

PinHole encounter_motion_pose_of(const Encounter *encounter, size_t joint, const double position[2],
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
    return encounter_motion_pose_of(encounter, joint, position, speed);
}

PinHole encounter_motion_pose(const Encounter *encounter, size_t joint, double time_s,
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

PinHole encounter_motion_flight(const Encounter *encounter, size_t joint, double time_s,
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
    return encounter_motion_pose_of(encounter, joint, position, speed);
}

void encounter_motion_all(const Encounter *encounter, double time_s, const double *impulse,
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

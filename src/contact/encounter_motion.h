// How the rows of an encounter move: the points of its local steps, and the poses of its joints at
// them.
#pragma once

#include "contact/encounter_input.h"

// Where a joint is at a point, and how fast its first two rows go; found when it is first asked
// for.
typedef struct EncounterPlaced {
    bool is_known;
    PinHole pose;
    double speed[2];
} EncounterPlaced;

// The state of an encounter at one time.
typedef struct EncounterPoint {
    double time_s;
    EncounterPlaced *placed; // by joint; owned
    double *impulse;         // N s, by row; the four are in one array that starts here
    double *moment;          // N s^2, its integral over time, by row, then that one's, N s^3
    double *force;           // N
    double *rate;            // N/s, of the forces along the motion
    double powers[2];        // W, lost in damping and in friction
    double power_rates[2];   // W/s
    double losses[2];        // J, likewise, since the start
} EncounterPoint;

// A point of so many rows and joints, all zero.
EncounterPoint encounter_point(size_t rows, size_t joints);
void encounter_point_free(EncounterPoint *point);

// Begins a point at another time, of which impulses and moments are about to be written.
void encounter_point_begin(const Encounter *encounter, EncounterPoint *point, double time_s);

// The pose of one joint at a point.
const PinHole *encounter_point_pose(const Encounter *encounter, const EncounterPoint *point,
                                    size_t joint);

// Which columns of a row's mobility may be other than zero.
typedef struct EncounterSpan {
    size_t first;
    size_t end;
} EncounterSpan;

static inline EncounterSpan encounter_span(const Encounter *encounter, size_t row)
{
    const size_t end = row + encounter->reach + 1;
    return (EncounterSpan){
        .first = row > encounter->reach ? row - encounter->reach : 0,
        .end = end < encounter->row_count ? end : encounter->row_count,
    };
}

// The motion of a row beside what acts in the encounter's own rows.
static inline double encounter_free_speed(const Encounter *encounter, size_t row, double time_s)
{
    const double speed = encounter->speed[row] + time_s * encounter->free[row];
    return encounter->input == NULL ? speed
                                    : speed + encounter_input_at(encounter, time_s)->speed[row];
}

static inline double encounter_free_position(const Encounter *encounter, size_t row, double time_s)
{
    const double position = encounter->position[row] +
                            time_s * (encounter->speed[row] + 0.5 * time_s * encounter->free[row]);
    return encounter->input == NULL
               ? position
               : position + encounter_input_at(encounter, time_s)->position[row];
}

static inline double encounter_free_rate(const Encounter *encounter, size_t row, double time_s)
{
    return encounter->input == NULL
               ? encounter->free[row]
               : encounter->free[row] + encounter_input_at(encounter, time_s)->acceleration[row];
}

// Moments, here and below, are by row the integrals of the impulses and then those of the
// integrals.

// Where all rows are, and how fast they go, after impulses and their integrals: the same sums as
// one by one in the order of the impulses, which the compiler turns into vectors.
void encounter_motion_all(const Encounter *encounter, double time_s, const double *impulse,
                          const double *moment, double *positions, double *speeds);

// The pose of a joint whose first two rows are where they are and go as fast as that.
PinHole encounter_motion_pose_of(const Encounter *encounter, size_t joint, const double position[2],
                                 const double speed[2]);

// The pose of one joint after impulses and their integrals.
PinHole encounter_motion_pose(const Encounter *encounter, size_t joint, double time_s,
                              const double *impulse, const double *moment);

// The same of what the joint's first two rows have moved, and how much faster they have become,
// beside the free motion.
PinHole encounter_motion_flight(const Encounter *encounter, size_t joint, double time_s,
                                const double moved[2], const double speeds[2]);

// The rate of a row, m/s or rad/s, after impulses and their integrals.
double encounter_motion_speed(const Encounter *encounter, size_t row, double time_s,
                              const double *impulse, const double *moment);

// The acceleration of a row, m/s^2 or rad/s^2, under forces, after impulses.
double encounter_motion_acceleration(const Encounter *encounter, size_t row, double time_s,
                                     const double *impulse, const double *force);

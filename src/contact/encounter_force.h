// The forces between pins and holes in an encounter, and the nodes that it leaves behind: what
// contact/encounter_run.c is made of.
#pragma once

#include "contact/encounter_input.h"

// Where a joint is at a point, and how fast its first two rows go; found when it is first asked for.
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

// How a joint that touches is at a point: its pose, how fast its rows go, what its spring presses
// with, N, and how fast that grows with the depth, N/m.
typedef struct EncounterTouch {
    PinHole pose;
    double speed[ENCOUNTER_ROWS_MOST];
    double elastic;
    double tangent;
} EncounterTouch;

enum { ENCOUNTER_ERRORS = 5 };

// What a step works with, by row and by joint.
typedef struct EncounterWork {
    EncounterPoint ends[2]; // of a local step
    EncounterPoint inside;  // the points of an explicit step
    EncounterPoint last;    // which forces that are asked for by themselves take as well
    EncounterPoint trial; // where a depth is looked at
    EncounterTouch *touching;
    double *forces;
    double *positions; // of rows that are worked out together
    double *speeds;
    double *errors[ENCOUNTER_ERRORS]; // of an implicit step
    double *crossings_s;              // when joints' depths are zero
    bool *has_event;                  // whether a contact begins or ends at the end of a local step
} EncounterWork;

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

// Writes the forces in all rows, and the powers lost in damping and in friction.
void encounter_force_find(Encounter *encounter, double time_s, const double *impulse,
                          const double *moment, double *force, double powers[2]);

// The same at a point, and how the joints are that touch, by joint.
void encounter_force_find_touching(Encounter *encounter, const EncounterPoint *point, double *force,
                                   double powers[2], EncounterTouch *touching);

// The pose of one joint after impulses and their integrals.
PinHole encounter_force_pose(const Encounter *encounter, size_t joint, double time_s,
                             const double *impulse, const double *moment);

// The same of what the joint's first two rows have moved, and how much faster they have become,
// beside the free motion.
PinHole encounter_force_flight(const Encounter *encounter, size_t joint, double time_s,
                               const double moved[2], const double speeds[2]);

// The rate of a row, m/s or rad/s, after impulses and their integrals.
double encounter_force_row_speed(const Encounter *encounter, size_t row, double time_s,
                                 const double *impulse, const double *moment);

// The acceleration of a row, m/s^2 or rad/s^2, under forces, after impulses.
double encounter_force_row_acceleration(const Encounter *encounter, size_t row, double time_s,
                                        const double *impulse, const double *force);

// How fast the damping of a contact at a depth takes up its closing speed, 1/s.
double encounter_force_decay(const Encounter *encounter, size_t joint, Vec2 normal, double depth);

// The frequency of a contact at a depth, rad/s.
double encounter_force_frequency(const Encounter *encounter, size_t joint, Vec2 normal,
                                 double depth);

// The time in which friction takes hold of what slides in a joint, s, under the forces given.
double encounter_force_friction_time(const Encounter *encounter, size_t joint, const double *force);

// Adds a node.
void encounter_nodes_add(Encounter *encounter, const EncounterPoint *point);

// Gives the first node the forces at the start that the first step, an implicit one, has found.
void encounter_nodes_settle(Encounter *encounter);

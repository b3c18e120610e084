// What happens where bodies touch while the linkage around them hardly changes: contacts integrated
// by themselves, in steps of their own, within one step of the world.
//
// Every place at which a joint with play can touch (contact/touch.h) is a joint here, with rows of
// its own. Of a pin in its hole: x and y of the pin's centre less the hole's, and with friction the
// turns of the hole's and of the pin's body; of two discs likewise. Of a circle on a line: the gap
// along the line's normal, and the sliding along it. In space x and y are across the pin's axis,
// and friction also has rows for the sliding along the axis and for the turns of both bodies about
// x and y (contact/pin_space_rows.h). What acts in a row moves all rows by the mobility of the
// linkage (model/response.h), which may turn with the bodies in the step (model/response_drift.h).
#pragma once

#include "contact/force_law.h"
#include "contact/pin_hole.h"
#include "contact/touch.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    ENCOUNTER_ROWS_PLAIN = 2, // of a joint without friction
    ENCOUNTER_ROWS_MOST = 9,  // with friction in space; RESPONSE_ROWS_A_JOINT in the plane
};

// The rows of a joint with friction, after those of its position: turns about the pin's axis of the
// hole's and of the pin's body, and in space the sliding along the axis, and the turns of both
// about x and y.
enum {
    ENCOUNTER_ROW_TURN = 2,
    ENCOUNTER_ROW_AXIAL = 4,
    ENCOUNTER_ROW_HOLE = 5,
    ENCOUNTER_ROW_PIN = 7,
};

// One place of a joint with play. The first six are given; the rest lives on from one step to the
// next. A disc outside another is a hole of negative size: the same formulas hold for both.
typedef struct EncounterJoint {
    ForceLaw law;
    TouchShape shape;
    double radial_clearance; // m; of a disc less than 0, minus the sum of the radii; not of a line
    double hole_radius;      // m; of a disc minus the radius of that on body a; not of a line
    int joint;               // number in the linkage
    int siblings[2];         // the first and the last place that can touch together with this one,
                             // counted from here; 0 and 0 where there is none
    bool has_friction;
    size_t first_row;
    size_t row_count;
    bool is_touching;
    double impact_speed;    // m/s, closing speed where the contact under way began
    double touching_s;      // s, since then
    double frequency;       // rad/s, of its oscillation at the depth to be expected
    double force_per_speed; // N s/m: the force to be expected of a closing speed
    double tolerance;       // 1: error of the force in a local step that is allowed, relative to it
    double first_width_s;   // of the first local step of a contact, and of the last
    double mobility_before[3]; // 1/kg: of its first two rows in the step before
    bool is_overdamped;        // its damping stops the pin long before its spring would
} EncounterJoint;

typedef struct Encounter {
    size_t joint_count;
    EncounterJoint *joints; // owned, as are all arrays
    size_t row_count;       // all joints together
    int *joint_of;          // of a row: which of the joints here
    size_t joint_room;      // of these arrays
    size_t row_room;
    double phase;        // rad of a contact's oscillation in one local step; 0: as many as suit
    double stiff_phase;  // rad, likewise, where steps are implicit
    double stable;       // time constants of a contact's damping in an explicit local step, at most
    double longest_s[2]; // of the next explicit step, of order 4 and 5
    double duration_before_s;       // of the step of the world before; 0: there was none
    struct EncounterStages *stages; // of implicit steps; NULL before the first
    struct EncounterWork *work;
    double stiff_width_s; // of the next implicit step; 0 where a contact has just begun

    // of the step under way, to be filled in before encounter_run
    double *mobility; // row by row: all of a row, or what is next to its diagonal
    size_t reach;     // rows further apart do not move each other
    size_t pitch;     // of `mobility`: between what two neighbouring rows have in one column
    size_t origin;    // likewise: of the first row and column
    double *drift;    // of few rows: how the mobility changes, 1/(kg s), laid out as it is; NULL
                      // where it is taken as constant in the step
    double *mobility_rate; // likewise, in the whole: what encounter_set_drift makes of it
    double *free_rate;     // how the free acceleration changes by itself; NULL with `drift`
    double middle_s;       // since the start: when mobility and free acceleration are as given
    double *free;          // acceleration while nothing acts
    double *position;      // at the start, m; of a line the gap and 0; not of turns
    double *speed;         // at the start, m/s, rad/s
    size_t event_most;  // times in a step at which contacts may begin or end, until it is given up
    size_t event_count; // so far in the step
    struct EncounterInput *input; // what others do to the rows; NULL: nothing. Not owned

    // what came of it: nodes, the first at the start, two where a contact begins or ends
    size_t node_count;
    size_t node_room;
    double *times;      // s, since the start
    double *values;     // by node: impulse, its integral over time, that one's, force; each by row
    double *closings;   // by node: closing speeds, m/s, of all joints; 0 where one does not touch
    double *losses;     // by node: J lost in damping and in friction since the start
    uint64_t *touching; // by node: which joints touch from there on, a word for each 64
    size_t evaluations; // of the forces, since the beginning
    double work_done;   // since it was set to 0: operations on one pair of rows
    double work_most;   // at which a step is given up; 0: never
} Encounter;

// How one place is at an instant, in its first two rows. The size of the eccentricity is less than
// 0 of a disc and infinite of a line.
typedef struct EncounterPose {
    PinHole pose;
    Vec2 force; // N, on the pin, friction included
    bool is_touching;
} EncounterPose;

// An encounter of no joints yet.
Encounter encounter_start(double phase);

// Adds a joint, of which the first six parts are given, with its rows: ENCOUNTER_ROWS_PLAIN, or
// more of one with friction, but for a line's.
void encounter_add(Encounter *encounter, const EncounterJoint *joint, size_t rows);

// Makes room for what a step is given, once all joints are there: mobilities, all zero, between
// rows that are no further apart than `reach`.
void encounter_make_room(Encounter *encounter, size_t reach);

// Makes room for positions, speeds and free accelerations alone, of one that is not run.
void encounter_make_rows(Encounter *encounter);
void encounter_finish(Encounter *encounter);

// The mobility of two rows no further apart than `reach`, by their numbers.
static inline double *encounter_mobility(const Encounter *encounter, size_t row, size_t column)
{
    return encounter->mobility + encounter->origin + row * encounter->pitch + column;
}

// Counts what one evaluation of the forces takes: of each row a force of its law, about as much as
// on so many pairs of rows, and what it does to the others.
enum { ENCOUNTER_ROW_WORK = 64 };
static inline void encounter_count_work(Encounter *encounter)
{
    const double rows = (double)encounter->row_count;
    encounter->work_done +=
        rows * (ENCOUNTER_ROW_WORK + fmin(rows, 2.0 * (double)encounter->reach + 1.0));
}

// The number of rows, all joints together.
size_t encounter_rows(const Encounter *encounter);

// Of an encounter whose rows all move each other: room for a mobility that changes in the step.
void encounter_make_drift(Encounter *encounter);

// Lets the mobility that has been filled in change in the step to come, of a length, s, about its
// middle: `drift` is S, row by row, 1/(kg s), with which the mobility grows by S + S' and an
// impulse P adds 2 S P to the rows' accelerations (model/response_drift.h). These change by
// themselves, too, as has been written to `free_rate`.
void encounter_set_drift(Encounter *encounter, const double *drift, double duration);

// Integrates a step of a length, s. Returns false where that takes more local steps than there can
// be sense in, or more events than are allowed.
bool encounter_run(Encounter *encounter, double duration);

// Impulses and their integrals over time, by row, and the losses, from the start to a time in the
// step, and the forces then.
typedef struct EncounterSums {
    double *impulse;   // N s, N m s; owned, as the next two
    double *moment;    // N s^2: integral of the impulse, by row, then that of the integral, N s^3
    double *force;     // N, N m
    double dissipated; // J
    double friction;   // J
} EncounterSums;

// Sums of so many rows, all zero.
EncounterSums encounter_sums(size_t rows);
void encounter_sums_free(EncounterSums *sums);

// What a node has in all rows: impulses, their integrals, these ones' integrals, and forces.
static inline const double *encounter_node_values(const Encounter *encounter, size_t node)
{
    return encounter->values + 4 * encounter->row_count * node;
}

static inline const double *encounter_node_forces(const Encounter *encounter, size_t node)
{
    return encounter_node_values(encounter, node) + 3 * encounter->row_count;
}

// The sums at a time between two neighbouring nodes, of which `node` is the first.
void encounter_at(const Encounter *encounter, size_t node, double time_s, EncounterSums *sums);

// The pose of one joint there, from the sums at the same time.
EncounterPose encounter_pose(const Encounter *encounter, size_t joint, size_t node, double time_s,
                             const EncounterSums *sums);

// The node at or before a time: the last of several at that time.
size_t encounter_node(const Encounter *encounter, double time_s);

// Whether a joint touches from a node on, and whether any does.
static inline bool encounter_touches(const Encounter *encounter, size_t node, size_t joint)
{
    const size_t words = (encounter->joint_count + 63) / 64;
    return (encounter->touching[node * words + joint / 64] >> joint % 64 & 1) != 0;
}
bool encounter_touches_any(const Encounter *encounter, size_t node);

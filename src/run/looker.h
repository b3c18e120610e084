// A solver's states at instants inside its last step, where it provides them.
#pragma once

#include "run/recorder.h"

// of a step; a chord of a quarter of a swing is then off by 1e-3 of its height
enum { LOOK_PARTS_MAX = 16, LOOK_TOPS_MAX = 8, LOOK_MAX = LOOK_PARTS_MAX + LOOK_TOPS_MAX };

// The signals at one instant.
typedef struct Look {
    double time_s;
    double *omega; // by body; in the looker's room, like the next two
    double *alpha;
    double *force; // by joint
} Look;

// The largest and the smallest value of a signal in a step.
enum { LOOK_SIGNS = 2 };

// Where a signal in a step has one of them.
typedef struct LookPeak {
    double time_s;
    double value;
    double omega; // rad/s, of a body
    bool is_known;
} LookPeak;

// Whom to ask. What it says the recorder sees, too. Looks are in its room until that is emptied.
typedef struct Looker {
    const Scenario *scenario;
    const Solver *solver;
    const void *state; // of the solver
    Recorder *recorder;
    const SolverPart *part; // of the last record: looks hold its bodies and joints; NULL: all
    const SolverSome *some; // of the record, where the part is what the solver is asked for of it
    Sample sample;          // owned, as the room
    size_t look_count;      // looks that are in the room
    size_t block_count;     // of them there is room for
    double **blocks;        // of one look each
    bool has_peaks;         // whether the last step was one in which a cluster was looked at
    LookPeak (*alpha_peaks)[LOOK_SIGNS]; // of it, by body; owned, like the next
    LookPeak (*force_peaks)[LOOK_SIGNS]; // by joint
} Looker;

Looker looker_start(const Scenario *scenario, const Solver *solver, const void *state,
                    Recorder *recorder);
void looker_finish(Looker *looker);

// A first look in the room, with nothing in it.
Look looker_first(Looker *looker);

// Empties the room but for the first look in it, which takes on what the look has of the part.
void looker_keep(Looker *looker, Look *first, const Look *look);

// A look in the room whose numbers the caller sets.
Look look_room(Looker *looker, double time_s);

// The solver's state at a time in the step.
Look look_inside(Looker *looker, double time_s);

// The end of a step as its record has it.
Look look_at_end(Looker *looker, const StepRecord *step);

// The peaks of the last step in which a cluster was looked at: alpha of a body or force of a joint.
LookPeak *looker_peaks(const Looker *looker, RecorderSignal which, size_t number);

// A signal at one instant.
typedef struct LookPoint {
    double time_s;
    double value;
    double omega; // rad/s, of a body
} LookPoint;

enum { LOOK_PATH_MAX = LOOK_MAX + LOOK_SIGNS };

// Alpha of a body or force of a joint at looks, and at its peaks between them where a cluster was
// looked at since the room was emptied. `before` is when the looks begin.
size_t look_path(const Looker *looker, RecorderSignal signal, size_t number, double before_s,
                 int count, const Look *looks, LookPoint path[LOOK_PATH_MAX]);

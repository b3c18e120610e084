// The interface every solver stands behind. A solver ends in one const Solver; run/ lists them.
//
// The caller opens it on a scenario, asks for steps until the time of the next sample is reached
// or passed, observes the sample, and closes it. It looks at the record of each step in between,
// so that nothing that lives shorter than a sample is lost. The first step comes before the first
// sample, so that every sample stands in a step and has accelerations and forces.
#pragma once

#include "base/carry.h"
#include "model/trajectory.h"

// The largest force, N, and depth, m, in a joint, and when they were reached, s; 0 where that is
// not known more exactly than by the step.
typedef struct JointPeak {
    double force;
    double depth;
    double force_s;
    double depth_s;
} JointPeak;

// Bodies and joints of a linkage that share nothing but the ground with the others, by their
// numbers there.
typedef struct SolverPart {
    size_t number; // of the part, less than the number of bodies of the linkage
    size_t body_count;
    size_t joint_count;
    const int *bodies;
    const int *joints;
} SolverPart;

// Some of the bodies and joints of a record, by their places in its arrays.
typedef struct SolverSome {
    size_t body_count;
    size_t joint_count;
    const size_t *bodies;
    const size_t *joints;
} SolverSome;

// What happened in one step. The arrays hold as many entries as the linkage, or the part that the
// record is of, has bodies or joints, and stay valid until the next call.
typedef struct StepRecord {
    const SolverPart *part; // whose bodies and joints these are, in its order; NULL: all
    bool is_partial;        // others are still to be stepped as far as this part: of the state now
                            // only this one may be observed
    double reached_s;       // of the last of several parts: up to where all have been stepped
    const SolverSome *changed; // whose values are those at end_s: all others' are still those of
                               // the last record that had them here; NULL: all
    double start_s;
    double end_s;
    double joint_s;           // the instant that the joints' states belong to
    const double *omega;      // rad/s, of each body at end_s
    bool is_smooth;           // no event lies within it: between its ends a polynomial follows
    bool is_mean;             // alpha and forces are means over the step, not those at its end
    const double *alpha;      // rad/s^2, of each body
    const JointState *joints; // force and gap as the force arose
    const SpaceJointState *space_joints; // likewise, of a linkage in space; else NULL
    const JointPeak *peaks;              // of each joint, which the steps up to this one show to
                                         // lie between them, beside those of `joints`; or NULL
    const double *impulse;               // N s, of each joint in the step
    const double *approach;              // m/s, closing speed at which each joint's contact began
    double drive_work;                   // J, done by the drive in the step
    double load_work;                    // J, done by loads in the step
    double dissipated;                   // J, in the contacts' damping in the step
    double friction;                     // J, in the contacts' friction in the step
    double elastic;                      // J, stored in the contacts at end_s
} StepRecord;

// What a solver built from the scenario, for people and for the record.
typedef struct SolverModel {
    char label[TRAJECTORY_LABEL_SIZE];
    double step_s;          // 0 where it has no fixed step
    size_t constraint_rows; // of the ideal joints
    size_t contact_rows;    // most so far; of the reference its joints with play
    size_t steps;           // taken so far
    double stepped_s;     // of motion, that they took: more than was asked for where a solver runs
                          // the whole motion at once; 0: as far as it was asked
    size_t evaluations;   // of the equations of motion so far, or of the forces of contacts that it
                          // integrates by itself; 0 where it does not count them
    size_t fallback_rows; // of contacts, to which a map was applied that the case does not ask for
    double wall_s;        // s, of the steps by a clock of the solver's own; 0: by that of the run
    const TrajectoryEngine *engine; // another one than ours; NULL: none
} SolverModel;

typedef struct Solver {
    const char *name; // as in a case's list of backends
    bool is_ideal;    // takes every joint as ideal, whatever its play
    // Optional: whether it can run the scenario at all, whose start may still have to be found:
    // asked before any long work. Fails with ERR_CASE, naming what it cannot run.
    bool (*check)(const Scenario *scenario, Err *err);
    // Makes the state at time zero. On failure *state stays NULL.
    bool (*open)(const Scenario *scenario, void **state, Err *err);
    // Takes one step of the solver's own choosing towards stop_s. It may end beyond stop_s only
    // if observe can look back into the step. A solver that hands on parts may take several of
    // each, though not at first. Fails with ERR_SOLVER, saying when and why.
    bool (*step)(void *state, double stop_s, Err *err);
    // Optional: takes a step as `step` does, but one that nobody wants a record of, which may take
    // less. Writes when it ended, s. NULL: step and record do.
    bool (*stride)(void *state, double stop_s, double *end_s, Err *err);
    // The record of the last step; not called before the first.
    StepRecord (*record)(const void *state);
    // The state at a time in the last step, both ends included. An omega that is no number marks a
    // state that the joints do not determine: the run ends there.
    void (*observe)(const void *state, double time_s, Sample *sample);
    // Optional: the bodies alone at the end of the last record, for less; NULL: observe has them.
    void (*observe_end)(const void *state, Sample *sample);
    // Of a solver that hands on parts: the same for the bodies and joints of the last record alone.
    void (*observe_part)(const void *state, double time_s, Sample *sample);
    // Of a solver whose records tell what has changed: the same for some bodies and joints of the
    // last record, in time that grows with their number alone. The rest of the sample is not for
    // use.
    void (*observe_some)(const void *state, double time_s, const SolverSome *some, Sample *sample);
    // Optional: what the signals of the last record are likely to be at a time in it, to within the
    // error of a step and without an evaluation: omega and alpha of its bodies, rad/s and rad/s^2,
    // forces of its joints, N. NAN where that is not known. Writes them in the record's order.
    void (*sketch)(const void *state, double time_s, double *omega, double *alpha, double *force);
    // Optional: the bodies' positions and velocities alone, which may take less; the rest of the
    // sample stays as it is. NULL: observe has them.
    void (*glance)(const void *state, double time_s, Sample *sample);
    // What the contacts of each joint carry at the end of the last step, by joint and its places.
    // NULL of solvers without contacts.
    void (*contacts)(const void *state, ContactState (*states)[JOINT_PLACES]);
    // Carries all that steps from the end of the last one on depend on, so that a state opened on
    // the same scenario, into which it is put back, takes the same steps to the last bit. Returns
    // false where the last step has not been handed on to its end: of taking after a later step.
    bool (*carry)(void *state, Carry *carry);
    SolverModel (*model)(const void *state);
    // Optional: extremes from a time on known better than from steps (a closed form), which return
    // every turn. NULL: taken from records.
    void (*extremes)(const void *state, double from_s, BodyExtremes *bodies);
    // Optional: corrects what was taken of the joints from records where those do not tell all.
    void (*totals)(const void *state, JointExtremes *joints);
    void (*close)(void *state);
} Solver;

// Up to where the whole linkage has been stepped with a record that is not partial, s.
static inline double solver_reached(const StepRecord *record)
{
    return record->part != NULL ? record->reached_s : record->end_s;
}

// Takes a step of a solver that nobody wants a record of, and writes when it ended, s.
static inline bool solver_stride(const Solver *solver, void *state, double stop_s, double *end_s,
                                 Err *err)
{
    if (solver->stride != NULL) {
        return solver->stride(state, stop_s, end_s, err);
    }
    for (;;) {
        if (!solver->step(state, stop_s, err)) {
            return false;
        }
        const StepRecord record = solver->record(state);
        *end_s = solver_reached(&record);
        if (!record.is_partial) {
            return true;
        }
    }
}

// The numbers of bodies and joints of a part, or of a whole linkage (NULL), and in the linkage that
// of each.
static inline size_t solver_body_count(const SolverPart *part, const Linkage *linkage)
{
    return part != NULL ? part->body_count : linkage->body_count;
}

static inline size_t solver_joint_count(const SolverPart *part, const Linkage *linkage)
{
    return part != NULL ? part->joint_count : linkage->joint_count;
}

static inline size_t solver_body(const SolverPart *part, size_t index)
{
    return part != NULL ? (size_t)part->bodies[index] : index;
}

static inline size_t solver_joint(const SolverPart *part, size_t index)
{
    return part != NULL ? (size_t)part->joints[index] : index;
}

// The bodies' positions and velocities at a time in the last step; the rest of the sample is not
// for use.
static inline void solver_glance(const Solver *solver, const void *state, double time_s,
                                 Sample *sample)
{
    (solver->glance != NULL ? solver->glance : solver->observe)(state, time_s, sample);
}

// The state at a time in the last step of what its record is of: of some of that, of a part, or of
// all (both NULL).
static inline void solver_look(const Solver *solver, const void *state, double time_s,
                               const SolverPart *part, const SolverSome *some, Sample *sample)
{
    if (some != NULL) {
        solver->observe_some(state, time_s, some, sample);
    } else if (part != NULL) {
        solver->observe_part(state, time_s, sample);
    } else {
        solver->observe(state, time_s, sample);
    }
}

// The solvers, by the names in OPTIONS_BACKEND_LIST.
#define SOLVER_DECLARE(id, word, solver, has_play) extern const Solver solver;
OPTIONS_BACKEND_LIST(SOLVER_DECLARE)

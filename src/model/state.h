// The state of a run at one instant: all that its future depends on. A run can be started from it,
// by any solver; and the solver that it was saved of can go on from it.
#pragma once

#include "model/solver.h"

// Whoever owns it can save and set it: plain arrays by body and by joint.
typedef struct RunState {
    double time_s; // since the start of the run that it is of
    size_t body_count;
    size_t joint_count;
    Sample sample; // how the bodies move, and where pins and blocks stand in their play
    ContactState (*contacts)[JOINT_PLACES]; // by joint and its places
    // What the solver that it was saved of carries besides: lengths of its next steps, corrections
    // and the like. Empty where that solver was in the midst of a step, or the state was not saved.
    Carry carry;
} RunState;

// Room for a state of a linkage, for run_state_free.
RunState run_state_create(const Linkage *linkage);
void run_state_free(RunState *state);

// Takes the state at the end of the last step of a solver, s, from its start: for a run that is
// started from it.
void run_state_take(const Solver *solver, void *of, double end_s, RunState *state);

// The same with what the solver carries, for one that resumes the run.
void run_state_save(const Solver *solver, void *of, double end_s, RunState *state);

// Opens a solver that goes on as if the run had not been stopped, to the last bit: the solver that
// the state was saved of, on the scenario of that run. The state must have something to carry.
bool run_state_resume(RunState *state, const Solver *solver, const Scenario *scenario, void **of,
                      Err *err);

// Makes a state the start of a scenario of the same linkage, whose time zero is then that of the
// state: the drive begins at the angle that it has come to. A drive whose speed changes over time
// must be where it began, and so must its torque; in space every drive must. Bodies that have
// turned by more than half a turn are turned back by whole turns, and what counts their angles with
// them.
void run_state_start(const RunState *state, Scenario *scenario);

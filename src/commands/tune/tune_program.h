// The program that --code writes, run before it is written: what it is worth is not derived from
// the trials, whose world is another, but measured.
#pragma once

#include "commands/tune/tune_runs.h"
#include "model/solver.h"

// Runs the worlds of the programs that could be written, and holds each against the reference at
// the times that it prints. Where the error is above the target, the step is shortened along the
// grid until it and the next finer one meet it; a step that is held stays. The cheapest that meets
// the target, or else the nearest, is the search's program; there is none where no setting can be
// written. Fails with ERR_SOLVER where there is no process left.
bool tune_program_run(const TuneSearch *search, const TuneReport *report, Err *err);

// The world of such a program as a solver for run_motion, of a case that tune_world_lacks finds
// nothing wrong with; its model counts the steps of ODE's world.
const Solver *tune_program_solver(void);

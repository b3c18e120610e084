// Mechanisms that share nothing but the ground, each stepped by itself by a solver of one.
#pragma once

#include "model/members.h"

// A solver of several: what its functions are made of. Each is stepped by a solver of one, whose
// steps count as having reached a time that they end short of by a share of themselves, for
// rounding.
bool several_open(const Scenario *scenario, const Solver *solver, double rounding, void **state,
                  Err *err);
bool several_step(void *state, double stop_s, Err *err);
bool several_stride(void *state, double stop_s, double *end_s, Err *err);
StepRecord several_record(const void *state);
void several_observe(const void *state, double time_s, Sample *sample);
void several_observe_part(const void *state, double time_s, Sample *sample);
void several_glance(const void *state, double time_s, Sample *sample);
void several_contacts(const void *state, ContactState (*states)[JOINT_PLACES]);
void several_close(void *state);

// Rows and evaluations are sums; steps are those of the mechanism that took most. The label is that
// of the first.
SolverModel several_model(const void *state);

// What they are made of, how many there are, and the solver's state of one of them.
const Scenario *several_scenario(const void *state);
size_t several_count(const void *state);
void *several_state(const void *state, size_t number);

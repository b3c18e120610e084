// Mechanisms that share nothing but the ground, each stepped by itself by a solver of one.
#pragma once

#include "model/components.h"

// A solver of several: what its functions are made of. Each is stepped by a solver of one, whose
// steps count as having reached a time that they end short of by a share of themselves, for
// rounding.
bool independent_open(const Scenario *scenario, const Solver *solver, double rounding, void **state,
                      Err *err);
bool independent_step(void *state, double stop_s, Err *err);
bool independent_stride(void *state, double stop_s, double *end_s, Err *err);
StepRecord independent_record(const void *state);
void independent_observe(const void *state, double time_s, Sample *sample);
void independent_observe_part(const void *state, double time_s, Sample *sample);
void independent_observe_some(const void *state, double time_s, const SolverSome *some,
                              Sample *sample);
void independent_sketch(const void *state, double time_s, double *omega, double *alpha,
                        double *force);
void independent_glance(const void *state, double time_s, Sample *sample);
void independent_contacts(const void *state, ContactState (*states)[JOINT_PLACES]);
bool independent_carry(void *state, Carry *carry);
void independent_close(void *state);

// Rows and evaluations are sums; steps are those of the mechanism that took most. The label is that
// of the first.
SolverModel independent_model(const void *state);

// Those that every solver of several has, for its const Solver.
#define INDEPENDENT_FUNCTIONS                                                                      \
    .step = independent_step, .record = independent_record, .observe = independent_observe,        \
    .observe_part = independent_observe_part, .observe_some = independent_observe_some,            \
    .contacts = independent_contacts, .carry = independent_carry, .close = independent_close

// What they are made of, how many there are, and the solver's state of one of them.
const Scenario *independent_scenario(const void *state);
size_t independent_count(const void *state);
void *independent_state(const void *state, size_t number);

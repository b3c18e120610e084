// ODE, started once in a process, its errors caught.
#pragma once

#include "base/carry.h"
#include "base/err.h"

#include <ode/ode.h>

// Starts ODE if it is not running yet, for this thread too, and takes over its error handlers; it
// stops with the process. Every thread that steps worlds calls it first.
void engine_start(void);

// One step of a world by the direct or the quick solver. ODE reports an internal error by ending
// the process; here it is caught and becomes ERR_SOLVER with ODE's own message, as does a message.
// The world is then fit for nothing but to be destroyed.
bool engine_step(dWorldID world, double step_s, bool is_quick, Err *err);

// Puts the quick solver's random numbers to a seed: it visits rows in a random order, and the
// generator is one for the whole process.
void engine_seed(size_t seed);

// Carries where a body is and how it moves, to the last bit.
void engine_carry_body(dBodyID body, Carry *carry);

// An implicit Runge-Kutta method of order 13 for motion that a strong damper makes stiff: its steps
// are as long as the motion is smooth, however short the time constants that have died away.
//
// It takes the steps of a Dop853, which then has the polynomial through the step and everything
// else as from its own stages.
#pragma once

#include "reference/dop853.h"
#include "reference/radau_newton.h"

typedef struct Radau {
    Dop853Method method; // what a Dop853 takes the steps by; the first member
    // Changes of the coordinates and their rates by which accelerations are differentiated: small
    // against what they depend on, large against rounding.
    double *nudge;
    Coupling *own_coupling; // owned, of an integrator without one
    RadauNewton newton;
    double decay;                // 1/s, the largest rate of decay, where it was last looked at
    double *moved[RADAU_STAGES]; // of the stages since the start of the step
    double *rates[RADAU_STAGES];
    double before_s; // length of the step whose polynomial the integrator has; 0 for none
    size_t filled;   // accepted steps before that one began
    // room to work in
    double *y;
    double *changed;
    double *kept;
    double *start;
    double *change; // of all stages' rates
    double *memory; // owned: all vectors above
} Radau;

// For the integrator of coordinates and their rates, as many of each, with sums behind them. Never
// NULL; the caller destroys it.
Radau *radau_create(const Dop853 *integrator);
void radau_destroy(Radau *radau);

// How fast rates die away where the next step starts: the largest rate of decay, 1/s. The next step
// takes nothing from one before.
double radau_look(Radau *radau, Dop853 *integrator);

// An implicit Runge-Kutta method of order 13 for motion that a strong damper makes stiff: its steps
// are as long as the motion is smooth, however short the time constants that have died away.
//
// It takes the steps of a Dop853, which then has the polynomial through the step and everything
// else as from its own stages.
#pragma once

#include "reference/dop853.h"

// The method's coefficients (reference/radau_table.c).
enum { RADAU_STAGES = 7, RADAU_DENSE_ROWS = 6 };

extern const double RADAU_NODE[RADAU_STAGES];
extern const double RADAU_COUPLING[RADAU_STAGES][RADAU_STAGES]; // the last row: the step's weights
// Of what the stages have moved since the start: the coefficients of degree 7 and 6 of the
// polynomial through them, and those that its ends leave open in the form of Dop853.
extern const double RADAU_LAST[2][RADAU_STAGES];
extern const double RADAU_DENSE[RADAU_DENSE_ROWS][RADAU_STAGES];

enum { RADAU_FREEDOM_MAX = DOP853_SIZE_MAX / 2 };

typedef struct Radau {
    Dop853Method method; // what a Dop853 takes the steps by; the first member
    // Changes of the coordinates and their rates by which accelerations are differentiated: small
    // against what they depend on, large against rounding.
    double nudge[DOP853_SIZE_MAX];
    // derivatives of the accelerations at the stages, 1/s^2 and 1/s
    double by_position[RADAU_STAGES][RADAU_FREEDOM_MAX * RADAU_FREEDOM_MAX];
    double by_rate[RADAU_STAGES][RADAU_FREEDOM_MAX * RADAU_FREEDOM_MAX];
    double decay; // 1/s, the sum of all rates of decay, where it was last looked at
    // Newton's method for all stages: coordinates that have nothing to do with one another are in
    // separate blocks, each factored by itself, one behind the other
    size_t block_count;
    size_t sizes[RADAU_FREEDOM_MAX];   // coordinates, by block
    size_t members[RADAU_FREEDOM_MAX]; // which they are, block by block
    double *matrix;                    // NULL before the first
    size_t *pivots;
    double moved[RADAU_STAGES][DOP853_SIZE_MAX]; // of the stages since the start of the step
    double rates[RADAU_STAGES][DOP853_SIZE_MAX];
    double before_s; // length of the step whose polynomial the integrator has; 0 for none
    size_t filled;   // accepted steps before that one began
} Radau;

// For a system of coordinates and their rates, as many of each, with sums behind them. Never NULL;
// the caller destroys it.
Radau *radau_create(void);
void radau_destroy(Radau *radau);

// How fast rates die away where the next step starts: the sum of all rates of decay, 1/s. The next
// step takes nothing from one before.
double radau_look(Radau *radau, Dop853 *integrator);

// The coefficients of the implicit Runge-Kutta method of order 13.
#pragma once

enum { RADAU_STAGES = 7, RADAU_DENSE_ROWS = 6 };

extern const double RADAU_NODE[RADAU_STAGES];
extern const double RADAU_COUPLING[RADAU_STAGES][RADAU_STAGES]; // the last row: the step's weights
// Of what the stages have moved since the start: the coefficients of degree 7 and 6 of the
// polynomial through them, and those that its ends leave open in the form of Dop853.
extern const double RADAU_LAST[2][RADAU_STAGES];
extern const double RADAU_DENSE[RADAU_DENSE_ROWS][RADAU_STAGES];

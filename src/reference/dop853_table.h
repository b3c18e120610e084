// Coefficients of the integrator in reference/dop853.h.
#pragma once

enum { DOP853_STAGES = 16, DOP853_DENSE_ROWS = 4 };

extern const double DOP853_NODE[DOP853_STAGES];
extern const double DOP853_COUPLING[DOP853_STAGES][DOP853_STAGES]; // row 12: the step's weights
extern const double DOP853_ERROR_5[DOP853_STAGES];
extern const double DOP853_ERROR_3[DOP853_STAGES];
extern const double DOP853_DENSE[DOP853_DENSE_ROWS][DOP853_STAGES];

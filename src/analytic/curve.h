// The extremes of a curve over an interval of the crank's angle.
#pragma once

#include "base/root.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct CurveExtreme {
    double low;       // smallest value in the interval
    double low_angle; // rad, the crank angle where it stands
    double high;
    double high_angle;
} CurveExtreme;

// A grid of half a degree, then Brent's method between its neighbours, so the values are right to
// rounding for any curve with no two extremes within a degree.
CurveExtreme curve_extreme(RootFunction value, void *context, double first_angle,
                           double last_angle);

// That grid.
typedef struct CurveGrid {
    double first; // rad
    double width; // rad
    size_t count;
} CurveGrid;

CurveGrid curve_grid(double first_angle, double last_angle);

double curve_grid_angle(const CurveGrid *grid, size_t number);

// One bound of a curve of which the values on the grid are known; `angle`, where it stands, rad,
// may be NULL.
double curve_bound(RootFunction value, void *context, const CurveGrid *grid, const double *samples,
                   bool is_high, double *angle);

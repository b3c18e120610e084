// The extremes of a curve over an interval of the crank's angle.
#pragma once

#include "base/root.h"

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

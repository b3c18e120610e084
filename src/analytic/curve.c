// Finds where a curve over the crank's angle is lowest and highest.
#include "analytic/curve.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

typedef struct Curve {
    RootFunction value;
    void *context;
    double sign; // -1: upside down, so that its minima are the maxima
} Curve;

static double signed_value(double crank_angle, void *context)
{
    const Curve *curve = context;
    return curve->sign * curve->value(crank_angle, curve->context);
}

CurveGrid curve_grid(double first_angle, double last_angle)
{
    const double half_degree = M_PI / 360.0;
    const size_t count = (size_t)ceil((last_angle - first_angle) / half_degree) + 1;
    const double width = (last_angle - first_angle) / (double)(count > 1 ? count - 1 : 1);
    return (CurveGrid){first_angle, width, count};
}

double curve_grid_angle(const CurveGrid *grid, size_t number)
{
    return grid->first + grid->width * (double)number;
}

double curve_bound(RootFunction value, void *context, const CurveGrid *grid, const double *samples,
                   bool is_high, double *angle)
{
    Curve curve = {value, context, is_high ? -1.0 : 1.0};
    size_t lowest = 0;
    for (size_t i = 1; i < grid->count; i++) {
        if (curve.sign * samples[i] < curve.sign * samples[lowest]) {
            lowest = i;
        }
    }
    double found = curve_grid_angle(grid, lowest);
    const bool is_inside = lowest > 0 && lowest + 1 < grid->count;
    const bool is_found = is_inside && root_minimum(signed_value, &curve, found - grid->width,
                                                    found, found + grid->width, &found);
    if (angle != NULL) {
        *angle = found;
    }
    return is_found ? value(found, context) : samples[lowest];
}

CurveExtreme curve_extreme(RootFunction value, void *context, double first_angle, double last_angle)
{
    const CurveGrid grid = curve_grid(fmin(first_angle, last_angle), fmax(first_angle, last_angle));
    double *samples = malloc(grid.count * sizeof *samples);
    assert(samples != NULL);
    for (size_t i = 0; i < grid.count; i++) {
        samples[i] = value(curve_grid_angle(&grid, i), context);
    }
    CurveExtreme extreme;
    extreme.low = curve_bound(value, context, &grid, samples, false, &extreme.low_angle);
    extreme.high = curve_bound(value, context, &grid, samples, true, &extreme.high_angle);
    free(samples);
    return extreme;
}

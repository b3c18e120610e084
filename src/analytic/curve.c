// Where is a curve over the crank's angle lowest and highest?
#include "analytic/curve.h"

#include <math.h>
#include <stddef.h>

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

// The smallest value of the curve between two angles and where it stands.
static double minimum(Curve *curve, double first, double last, double *angle)
{
    const double half_degree = M_PI / 360.0;
    const size_t count = (size_t)ceil((last - first) / half_degree) + 1;
    const double width = (last - first) / (double)(count > 1 ? count - 1 : 1);
    size_t lowest = 0;
    double value = signed_value(first, curve);
    for (size_t i = 1; i < count; i++) {
        const double here = signed_value(first + width * (double)i, curve);
        if (here < value) {
            value = here;
            lowest = i;
        }
    }
    *angle = first + width * (double)lowest;
    if (lowest > 0 && lowest + 1 < count &&
        root_minimum(signed_value, curve, *angle - width, *angle, *angle + width, angle)) {
        value = signed_value(*angle, curve);
    }
    return value;
}

CurveExtreme curve_extreme(RootFunction value, void *context, double first_angle, double last_angle)
{
    CurveExtreme extreme;
    const double first = fmin(first_angle, last_angle);
    const double last = fmax(first_angle, last_angle);
    Curve curve = {value, context, 1.0};
    extreme.low = minimum(&curve, first, last, &extreme.low_angle);
    curve.sign = -1.0;
    extreme.high = -minimum(&curve, first, last, &extreme.high_angle);
    return extreme;
}

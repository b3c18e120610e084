// sin x / x and cos x, quick where x is small, as the angles of one step are.
#pragma once

#include <math.h>

// Below this the series to x^8 and x^10 leave less than rounding: .1^10 / 11! and .1^12 / 12!.
static const double SINC_SMALL = 0.1; // rad

static inline double sinc(double x)
{
    const double square = x * x;
    if (fabs(x) >= SINC_SMALL) {
        return sin(x) / x;
    }
    return 1.0 -
           square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)));
}

static inline double sinc_cos(double x)
{
    const double square = x * x;
    if (fabs(x) >= SINC_SMALL) {
        return cos(x);
    }
    return 1.0 -
           square / 2.0 *
               (1.0 - square / 12.0 *
                          (1.0 - square / 30.0 * (1.0 - square / 56.0 * (1.0 - square / 90.0))));
}

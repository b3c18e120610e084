// Quantiles of the normal distribution, whole and between two limits.
//
// Between limits a and b:  z = P^-1(P(a) + u (P(b) - P(a))), P the distribution and u the share.
// Above 0, where P is next to 1 and has lost its digits, the mirror image is taken.
//
//     P(z) = erfc(-z / sqrt 2) / 2
//
// P^-1 is PPND16, three quotients of polynomials of degree 7, right to about 1e-16 of z: Wichura,
// Algorithm AS 241: The percentage points of the normal distribution, Applied Statistics 37 (1988)
// 477-484.
#include "commands/study/normal.h"

#include <math.h>

enum { DEGREE = 7 };

// A quotient of two polynomials, the coefficients by rising power.
typedef struct Quotient {
    double above[DEGREE + 1];
    double below[DEGREE + 1];
} Quotient;

// of .180625 - q^2, for q = p - 1/2 up to .425 from 0
static const double MIDDLE_MAX = 0.425;
static const double MIDDLE_SQUARE = 0.180625;
static const Quotient MIDDLE = {
    {3.3871328727963666080e0, 1.3314166789178437745e+2, 1.9715909503065514427e+3,
     1.3731693765509461125e+4, 4.5921953931549871457e+4, 6.7265770927008700853e+4,
     3.3430575583588128105e+4, 2.5090809287301226727e+3},
    {1.0, 4.2313330701600911252e+1, 6.8718700749205790830e+2, 5.3941960214247511077e+3,
     2.1213794301586595867e+4, 3.9307895800092710610e+4, 2.8729085735721942674e+4,
     5.2264952788528545610e+3},
};
// of r - 1.6, for r = sqrt(-log p) up to 5, p the smaller tail
static const double NEAR_MAX = 5.0;
static const double NEAR_SHIFT = 1.6;
static const Quotient NEAR_TAIL = {
    {1.42343711074968357734e0, 4.63033784615654529590e0, 5.76949722146069140550e0,
     3.64784832476320460504e0, 1.27045825245236838258e0, 2.41780725177450611770e-1,
     2.27238449892691845833e-2, 7.74545014278341407640e-4},
    {1.0, 2.05319162663775882187e0, 1.67638483018380384940e0, 6.89767334985100004550e-1,
     1.48103976427480074590e-1, 1.51986665636164571966e-2, 5.47593808499534494600e-4,
     1.05075007164441684324e-9},
};
// of r - 5 beyond
static const Quotient FAR_TAIL = {
    {6.65790464350110377720e0, 5.46378491116411436990e0, 1.78482653991729133580e0,
     2.96560571828504891230e-1, 2.65321895265761230930e-2, 1.24266094738807843860e-3,
     2.71155556874348757815e-5, 2.01033439929228813265e-7},
    {1.0, 5.99832206555887937690e-1, 1.36929880922735805310e-1, 1.48753612908506148525e-2,
     7.86869131145613259100e-4, 1.84631831751005468180e-5, 1.42151175831644588870e-7,
     2.04426310338993978564e-15},
};

double normal_below(double z)
{
    return 0.5 * erfc(-z * M_SQRT1_2);
}

double normal_above(double z)
{
    return 0.5 * erfc(z * M_SQRT1_2);
}

double normal_between(double low, double high)
{
    return low > 0.0 ? normal_above(low) - normal_above(high)
                     : normal_below(high) - normal_below(low);
}

static double quotient_at(const Quotient *quotient, double x)
{
    double above = quotient->above[DEGREE];
    double below = quotient->below[DEGREE];
    for (int i = DEGREE - 1; i >= 0; i--) {
        above = above * x + quotient->above[i];
        below = below * x + quotient->below[i];
    }
    return above / below;
}

// The z below which lies the share p, at most 1/2: PPND16.
static double inverse_below(double p)
{
    const double q = p - 0.5;
    if (fabs(q) <= MIDDLE_MAX) {
        return q * quotient_at(&MIDDLE, MIDDLE_SQUARE - q * q);
    }
    if (p <= 0.0) {
        return -INFINITY;
    }
    const double r = sqrt(-log(p));
    return r <= NEAR_MAX ? -quotient_at(&NEAR_TAIL, r - NEAR_SHIFT)
                         : -quotient_at(&FAR_TAIL, r - NEAR_MAX);
}

double normal_quantile(double share, double low, double high)
{
    if (low > 0.0) {
        return -normal_quantile(1.0 - share, -high, -low);
    }
    // from the nearer end, so that small shares of either tail keep their digits
    const double whole = normal_between(low, high);
    const double below = normal_below(low) + share * whole;
    const double z = below <= 0.5 ? inverse_below(below)
                                  : -inverse_below(normal_above(high) + (1.0 - share) * whole);
    return fmin(fmax(z, low), high);
}

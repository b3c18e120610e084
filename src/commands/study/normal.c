// Which value of a normal distribution has a given share of it below?
//
// Between limits a and b:  z = P^-1(P(a) + u (P(b) - P(a))), P the distribution and u the share.
// Above 0, where P is next to 1 and has lost its digits, the mirror image is taken.
#include "commands/study/normal.h"

#include <gsl/gsl_cdf.h>
#include <math.h>

double normal_below(double z)
{
    return gsl_cdf_ugaussian_P(z);
}

double normal_above(double z)
{
    return gsl_cdf_ugaussian_Q(z);
}

double normal_between(double low, double high)
{
    return low > 0.0 ? normal_above(low) - normal_above(high)
                     : normal_below(high) - normal_below(low);
}

double normal_quantile(double share, double low, double high)
{
    if (low > 0.0) {
        return -normal_quantile(1.0 - share, -high, -low);
    }
    // from the nearer end, so that small shares of either tail keep their digits
    const double whole = normal_between(low, high);
    const double below = normal_below(low) + share * whole;
    const double z = below <= 0.5
                         ? gsl_cdf_ugaussian_Pinv(below)
                         : gsl_cdf_ugaussian_Qinv(normal_above(high) + (1.0 - share) * whole);
    return fmin(fmax(z, low), high);
}

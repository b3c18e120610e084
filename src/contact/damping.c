// How much of an impact's speed does a damped contact law give back, and which factor gives back
// what was asked for?
//
// Hysteretic damping     F = K d^n (1 + chi d'/v0)
//   delivered            chi (1 + e) = ln((1 + chi) / (1 - chi e)), whatever n, K and m
//   deepest point        d^(n+1) = (n + 1) m v0^2 / K (1/chi - ln(1 + chi) / chi^2)
//   With r(x) = (ln(1 + x) - x) / x^2 both lose no digits at small chi:
//                        r(chi) = e^2 r(-chi e),  d^(n+1) = -(n + 1) m v0^2 / K r(chi)
// Linear spring-damper   e = exp(-2 z acos(z) / sqrt(1 - z^2)) for z < 1, exp(-2) at z = 1,
//   clamped at F >= 0    exp(-2 z acosh(z) / sqrt(z^2 - 1)) for z > 1, about 1 / (4 z^2)
//   Contact ends where F = 0, hence d'' = 0: at the phase omega_d t = 2 acos z, where the speed
//   is -v0 exp(-z omega t). Beyond z = 1 the same with hyperbolic functions.
//
// The factors of the laws by name are in OPTIONS_DAMPING_LIST of model/options.h.
//
// e restitution, 1; chi hysteresis factor, 1; z damping ratio c / (2 sqrt(k m)), 1; d penetration,
// m; v0 impact speed, m/s; m effective mass, kg; K, n stiffness, N/m^n, and exponent.
//
// Sources: Lankarani and Nikravesh, J. Mech. Des. 112 (1990) 369; Hunt and Crossley, J. Appl. Mech.
// 42 (1975) 440; Flores et al., Multibody Syst. Dyn. 25 (2011) 357; Gonthier et al., Multibody
// Syst. Dyn. 11 (2004) 209; Hu and Guo, Mech. Res. Commun. 66 (2015) 16.
#include "contact/damping.h"

#include "base/root.h"

#include <assert.h>
#include <float.h>
#include <math.h>

// below this the series of r(x) is used: 16 terms leave 0.1^17 / 18 of the sum
static const double SERIES_LIMIT = 0.1;
enum { SERIES_TERMS = 16 };

// r(x) = (ln(1 + x) - x) / x^2 for x > -1; -1/2 at 0.
static double log_remainder(double x)
{
    if (fabs(x) >= SERIES_LIMIT) {
        return (log1p(x) - x) / (x * x);
    }
    double sum = 0.0;
    for (int i = SERIES_TERMS; i >= 0; i--) {
        sum = 1.0 / (i + 2.0) - x * sum;
    }
    return -sum;
}

// Zero where chi delivers e; negative where chi is too small for it.
static double mismatch(double chi, double e)
{
    return log_remainder(chi) - e * e * log_remainder(-chi * e);
}

static double mismatch_of_chi(double chi, void *context)
{
    return mismatch(chi, *(const double *)context);
}

static double mismatch_of_e(double e, void *context)
{
    return mismatch(*(const double *)context, e);
}

static double exact_factor(double e)
{
    if (e == 1.0) {
        return 0.0;
    }
    // chi e < 1 always; where even the number next to 1 is too small, it is the answer
    const double highest = (1.0 - 2.0 * DBL_EPSILON) / e;
    double chi = highest;
    root_find(mismatch_of_chi, &e, 0.5 * (1.0 - e), highest, 0.0, &chi);
    return chi;
}

double damping_factor(DampingKind kind, double restitution)
{
#define DAMPING_FACTOR(name, word, words, factor)                                                  \
    case DAMPING_##name:                                                                           \
        return factor;
    assert(restitution >= 0.0 && restitution <= 1.0);
    const double e = restitution;
    switch (kind) {
        OPTIONS_DAMPING_LIST(DAMPING_FACTOR)
    case DAMPING_COUNT:
        break;
    }
    return 0.0;
}

double damping_delivered(double chi)
{
    assert(chi >= 0.0);
    if (chi == 0.0) {
        return 1.0;
    }
    // e < 1/chi always; above chi = 39 the two are one number
    const double highest = fmin(1.0, (1.0 - 2.0 * DBL_EPSILON) / chi);
    double e = highest;
    root_find(mismatch_of_e, &chi, 0.0, highest, 0.0, &e);
    return e;
}

double damping_depth_max(double stiffness, double exponent, double chi, double mass, double speed)
{
    const double order = exponent + 1.0;
    const double scale = order * mass * speed * speed / stiffness;
    return pow(-scale * log_remainder(chi), 1.0 / order);
}

// of the damping: its square is no double's any more
static const double HUGE_RATIO = 1e150;

// z acos(z) / sqrt(1 - z^2), continued through z = 1.
static double phase_decay(double z)
{
    if (z > HUGE_RATIO) {
        return log(2.0) + log(z); // asinh z
    }
    const double root = sqrt(fabs((1.0 - z) * (1.0 + z)));
    if (root == 0.0) {
        return 1.0;
    }
    return z * (z < 1.0 ? atan2(root, z) : asinh(root)) / root;
}

double damping_linear_restitution(double zeta)
{
    assert(zeta >= 0.0);
    return exp(-2.0 * phase_decay(zeta));
}

static double decay_mismatch(double zeta, void *context)
{
    return 2.0 * phase_decay(zeta) + *(const double *)context;
}

double damping_linear_ratio(double restitution)
{
    assert(restitution > 0.0 && restitution <= 1.0);
    double log_e = log(restitution);
    double zeta = 0.0;
    // e lies below 1/z^2 for every z, so the root lies below this end
    const bool is_found =
        root_find(decay_mismatch, &log_e, 0.0, 1.0 / sqrt(restitution), 0.0, &zeta);
    assert(is_found);
    (void)is_found;
    return zeta;
}

// Computes the force with which pin and hole press on each other at a given penetration.
//
// Power family           F = K d^n,  dF/dd = n F / d,  W = F d / (n + 1)
// Logarithmic family     d = A F (B - ln F)
//   with y = B - ln F    y - ln y = L,  L = B + ln A - ln d,  F = d / (A y)
//                        dF/dd = 1 / (A (y - 1)),  W = A F^2 (2 y - 1) / 4
//   The branch y > 1 is the physical one: F grows with d. It ends at y = 1, d = A e^(B-1).
// Conforming family      kernel/conforming.h
// Damping                F_total = max(0, F + (chi F / max(v0, floor) + c(d)) d')
//   c(d) = c x^2 (3 - 2 x), x = d / d_full, up to d_full and c beyond it; c where d_full is 0
//
// d penetration, m; F force, N; K stiffness, N/m^n; n exponent, 1; A compliance, m/N; B offset, 1
// (with F in N); W elastic energy, J; chi hysteresis factor, 1; c viscous coefficient, N s/m;
// d_full depth of full damping, m; v0 closing speed at the onset of contact, m/s; d' rate of d,
// m/s.
//
// Sources: K. L. Johnson, Contact Mechanics (1985), ch. 4 and 5; ESDU 78035 (1978); Hunt and
// Crossley, J. Appl. Mech. 42 (1975) 440, for the damping term F chi d' / v0; MSC Adams, function
// IMPACT, for the damping that grows with the depth.
#include "kernel/force_law.h"

#include <assert.h>
#include <math.h>
#include <string.h>

// the closing speed of a pin let go a fraction of a micron from the wall
static const double DEFAULT_SPEED_FLOOR = 1e-3;

// each step leaves the fourth power of the error before; from the starting values below, never
// wrong by more than 2.5 %, two reach the last bit
enum { ITERATION_COUNT = 2 };

// below this L the expansion about the end of the branch is the better starting value
static const double SERIES_LIMIT = 2.2;

// of L, a difference of logarithms of some tens each: at the depth limit itself there is a force
static const double LEVEL_ROUNDING = 1e-13;

ForceLaw force_law_power(double stiffness, double exponent)
{
    return (ForceLaw){
        .family = FORCE_LAW_POWER,
        .stiffness = stiffness,
        .exponent = exponent,
        .depth_most = INFINITY,
        .impact_speed_floor = DEFAULT_SPEED_FLOOR,
    };
}

ForceLaw force_law_logarithmic(double compliance, double offset)
{
    return (ForceLaw){
        .family = FORCE_LAW_LOGARITHMIC,
        .compliance = compliance,
        .offset = offset,
        .log_scale = offset + log(compliance),
        .depth_most = INFINITY,
        .impact_speed_floor = DEFAULT_SPEED_FLOOR,
    };
}

ForceLaw force_law_conforming(double stiffness, double play, const double *series)
{
    ForceLaw law = {
        .family = FORCE_LAW_CONFORMING,
        .conforming = {.stiffness = stiffness, .play = play},
        .depth_most = INFINITY,
        .impact_speed_floor = DEFAULT_SPEED_FLOOR,
    };
    memcpy(law.conforming.series, series, sizeof law.conforming.series);
    return law;
}

static bool is_conforming_sound(const Conforming *law)
{
    const double widest = law->play * conforming_depth(-1.0); // where W is least
    const double secant = conforming_secant(law, widest);
    return law->stiffness > 0.0 && law->play > 0.0 && isfinite(law->play) && secant > 0.0 &&
           isfinite(secant);
}

bool force_law_is_linear(const ForceLaw *law)
{
    return law->family == FORCE_LAW_POWER && law->exponent == 1.0 && law->hysteresis == 0.0 &&
           law->full_damping_depth == 0.0;
}

bool force_law_is_sound(const ForceLaw *law)
{
    if (law->family == FORCE_LAW_CONFORMING) {
        return is_conforming_sound(&law->conforming);
    }
    if (law->family == FORCE_LAW_POWER) {
        return law->stiffness > 0.0 && isfinite(law->stiffness) && law->exponent > 0.0 &&
               isfinite(law->exponent);
    }
    return law->compliance > 0.0 && isfinite(law->compliance) && isfinite(law->offset) &&
           isfinite(law->log_scale);
}

ForceLaw force_law_share(const ForceLaw *law, double share)
{
    assert(share > 0.0);
    ForceLaw part = *law;
    part.stiffness *= share;
    part.conforming.stiffness *= share;
    part.viscous *= share;
    if (law->family == FORCE_LAW_LOGARITHMIC) {
        // d = A F (B - ln F) with F of the whole = F of the part / share
        part.compliance /= share;
        part.offset += log(share);
    }
    return part;
}

// The root y >= 1 of y - ln y = L; NaN where L < 1.
static double solve_branch(double level)
{
    if (!(level >= 1.0 - LEVEL_ROUNDING)) {
        return NAN;
    }
    level = fmax(level, 1.0);
    // start: the expansion about y = 1, or the one for large y
    double y;
    if (level < SERIES_LIMIT) {
        const double s = sqrt(2.0 * (level - 1.0));
        y = 1.0 + s * (1.0 + s * (1.0 / 3.0 + s / 36.0));
    } else {
        const double log_level = log(level);
        y = level + log_level + log_level / level;
    }
    // Fritsch's iteration for the Lambert function, written for y
    for (int i = 0; i < ITERATION_COUNT; i++) {
        const double residual = level - (y - log(y));
        const double slope = y - 1.0;
        if (slope == 0.0 || fabs(residual) <= 4e-16 * y) {
            break;
        }
        const double q = 2.0 * slope * (slope - 2.0 / 3.0 * residual);
        const double correction = residual / slope * (q + residual) / (q + 2.0 * residual);
        y += y * correction;
    }
    return y;
}

static double branch_at(const ForceLaw *law, double penetration)
{
    return solve_branch(law->log_scale - log(penetration));
}

static double power(double base, double exponent)
{
    if (exponent == 1.5) {
        return base * sqrt(base);
    }
    return exponent == 1.0 ? base : pow(base, exponent);
}

double force_law_depth_limit(const ForceLaw *law)
{
    return law->family == FORCE_LAW_LOGARITHMIC ? exp(law->log_scale - 1.0) : INFINITY;
}

double force_law_elastic(const ForceLaw *law, double penetration)
{
    if (penetration <= 0.0) {
        return 0.0;
    }
    if (law->family == FORCE_LAW_POWER) {
        return law->stiffness * power(penetration, law->exponent);
    }
    if (law->family == FORCE_LAW_CONFORMING) {
        return conforming_secant(&law->conforming, penetration) * penetration;
    }
    return penetration / (law->compliance * branch_at(law, penetration));
}

double force_law_tangent(const ForceLaw *law, double penetration)
{
    if (law->family == FORCE_LAW_POWER) {
        return law->exponent * force_law_secant(law, penetration);
    }
    if (penetration <= 0.0) {
        return 0.0;
    }
    if (law->family == FORCE_LAW_CONFORMING) {
        double force;
        double slope;
        conforming_both(&law->conforming, penetration, &force, &slope);
        return slope;
    }
    return 1.0 / (law->compliance * (branch_at(law, penetration) - 1.0));
}

void force_law_both(const ForceLaw *law, double penetration, double *elastic, double *tangent)
{
    if (law->family == FORCE_LAW_POWER) {
        const double secant = force_law_secant(law, penetration);
        *elastic = penetration <= 0.0 ? 0.0 : secant * penetration;
        *tangent = law->exponent * secant;
        return;
    }
    if (penetration <= 0.0) {
        *elastic = *tangent = 0.0;
        return;
    }
    if (law->family == FORCE_LAW_CONFORMING) {
        conforming_both(&law->conforming, penetration, elastic, tangent);
        return;
    }
    const double branch = branch_at(law, penetration);
    *elastic = penetration / (law->compliance * branch);
    *tangent = 1.0 / (law->compliance * (branch - 1.0));
}

double force_law_secant(const ForceLaw *law, double penetration)
{
    if (law->family == FORCE_LAW_POWER) {
        const double depth = fmax(penetration, 0.0);
        if (law->exponent == 1.5) {
            return law->stiffness * sqrt(depth);
        }
        return law->exponent == 1.0 ? law->stiffness
                                    : law->stiffness * pow(depth, law->exponent - 1.0);
    }
    if (law->family == FORCE_LAW_CONFORMING) {
        return conforming_secant(&law->conforming, penetration);
    }
    return penetration <= 0.0 ? 0.0 : 1.0 / (law->compliance * branch_at(law, penetration));
}

// What the law has at a penetration and a rate but for the slopes.
static ForceLawDamped damped_at(const ForceLaw *law, double penetration, double rate,
                                double impact_speed)
{
    const ForceLawTerms at = {
        .elastic = force_law_elastic(law, penetration),
        .viscous = force_law_viscous(law, penetration),
    };
    return force_law_damped(at, force_law_damping_rate(law, impact_speed), rate);
}

double force_law_damping(const ForceLaw *law, double penetration, double impact_speed)
{
    // beyond the law's depths its damper is still known
    return law->hysteresis == 0.0 ? force_law_viscous(law, penetration)
                                  : damped_at(law, penetration, 0.0, impact_speed).by_rate;
}

double force_law_force(const ForceLaw *law, double penetration, double rate, double impact_speed)
{
    if (penetration <= 0.0) {
        return 0.0;
    }
    const double total = damped_at(law, penetration, rate, impact_speed).force;
    return total < 0.0 ? 0.0 : total; // a comparison that lets NaN through
}

double force_law_penetration(const ForceLaw *law, double force)
{
    if (force <= 0.0) {
        return 0.0;
    }
    if (law->family == FORCE_LAW_POWER) {
        return pow(force / law->stiffness, 1.0 / law->exponent);
    }
    if (law->family == FORCE_LAW_CONFORMING) {
        return conforming_penetration(&law->conforming, force);
    }
    const double y = law->offset - log(force);
    return y >= 1.0 ? law->compliance * force * y : NAN;
}

double force_law_energy(const ForceLaw *law, double penetration)
{
    if (penetration <= 0.0) {
        return 0.0;
    }
    if (law->family == FORCE_LAW_POWER) {
        return force_law_elastic(law, penetration) * penetration / (law->exponent + 1.0);
    }
    if (law->family == FORCE_LAW_CONFORMING) {
        return conforming_energy(&law->conforming, penetration);
    }
    const double y = branch_at(law, penetration);
    const double force = penetration / (law->compliance * y);
    return 0.25 * law->compliance * force * force * (2.0 * y - 1.0);
}

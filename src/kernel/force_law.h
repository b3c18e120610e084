// The law of a contact: the force between pin and hole as a function of penetration and its rate,
// and the friction that it holds, ready for the inner loop of every solver.
//
// Penetration is positive inside the metal, its rate positive while it grows; the force is the
// pressing force along the normal and never negative.
#pragma once

#include "kernel/bristle.h"
#include "kernel/conforming.h"

#include <math.h>
#include <stdbool.h>

typedef enum ForceLawFamily {
    FORCE_LAW_POWER,       // F = K d^n
    FORCE_LAW_LOGARITHMIC, // d = A F (B - ln F), F in N: cylinder in a hole
    FORCE_LAW_CONFORMING,  // F = k d / W(d / play): cylinder in the hole of an eye, by elasticity
                           // (kernel/conforming.h)
} ForceLawFamily;

typedef struct ForceLaw {
    ForceLawFamily family;
    double stiffness;          // K, N/m^n, of FORCE_LAW_POWER
    double exponent;           // n, 1, of FORCE_LAW_POWER
    double compliance;         // A, m/N, of FORCE_LAW_LOGARITHMIC
    double offset;             // B, 1, of FORCE_LAW_LOGARITHMIC
    double log_scale;          // B + ln(A / (m/N)), 1: set by force_law_logarithmic
    double depth_most;         // m, up to which what the law is made of holds; infinite: any depth
    double hysteresis;         // chi, 1: F = F_el (1 + chi d'/v0); 0 for none
    double viscous;            // c, N s/m: F = F_el + c d'; 0 for none
    double full_damping_depth; // m, > 0: c grows from 0 at the wall to its value at this depth, by
                               // a cubic step; 0: it is whole from the onset on
    double impact_speed_floor; // m/s, > 0: smallest v0 the hysteretic damping divides by
    double resting_speed;      // m/s: v0 of a contact that has outlasted its impact
                               // (kernel/contact_state.h); 0: that of its impact for ever
    double friction;           // mu, 1: Coulomb's coefficient; 0 for none
    double friction_speed;     // v_s, m/s: mu N tanh(v / v_s); > 0 where there is friction
    BristlePair bristle;       // of friction that holds, in place of that
    Conforming conforming;     // of FORCE_LAW_CONFORMING
} ForceLaw;

// The families, of any depth, without damping and friction, with an impact speed floor of 1 mm/s.
// Every number must be > 0 (B and the series' may be anything).
ForceLaw force_law_power(double stiffness, double exponent);
ForceLaw force_law_logarithmic(double compliance, double offset);
ForceLaw force_law_conforming(double stiffness, double play, const double *series);

// That law with a coefficient of friction and the sliding speed, m/s, over which it sets in.
static inline ForceLaw force_law_with_friction(ForceLaw law, double friction, double speed)
{
    law.friction = friction;
    law.friction_speed = speed;
    return law;
}

// Whether a spring and a damper of constants make the whole of it.
bool force_law_is_linear(const ForceLaw *law);

// Whether all numbers of the elastic part are finite and of the right sign.
bool force_law_is_sound(const ForceLaw *law);

// The law of one of several places that share a contact's load, > 0: that share of its force,
// elastic and damping, at every penetration.
ForceLaw force_law_share(const ForceLaw *law, double share);

// The deepest penetration the law can describe, m: A e^(B-1) of the logarithmic family, where
// the force has no finite slope any more; infinite for the others.
double force_law_depth_limit(const ForceLaw *law);

// Elastic force, N, at a penetration, m; 0 where it is not positive; NaN beyond the depth limit,
// so that the run ends with a status.
double force_law_elastic(const ForceLaw *law, double penetration);

// Slope of the elastic force, N/m. At no penetration: 0 for n > 1, K for n = 1, infinite for
// n < 1, 0 for the others (their stiffness vanishes as 1 / ln d).
double force_law_tangent(const ForceLaw *law, double penetration);

// Both at once, from one solution of the law.
void force_law_both(const ForceLaw *law, double penetration, double *elastic, double *tangent);

// Elastic force over penetration, N/m: the spring that gives the exact force there. At no
// penetration: its limit, as for the tangent.
double force_law_secant(const ForceLaw *law, double penetration);

// The viscous coefficient c(d), N s/m, at a penetration, m.
static inline double force_law_viscous(const ForceLaw *law, double penetration)
{
    if (!(law->full_damping_depth > 0.0) || penetration >= law->full_damping_depth) {
        return law->viscous;
    }
    const double share = penetration / law->full_damping_depth;
    return penetration > 0.0 ? law->viscous * share * share * (3.0 - 2.0 * share) : 0.0;
}

// Its slope, N s/m^2.
static inline double force_law_viscous_slope(const ForceLaw *law, double penetration)
{
    if (!(penetration > 0.0 && penetration < law->full_damping_depth)) {
        return 0.0;
    }
    const double share = penetration / law->full_damping_depth;
    return law->viscous * 6.0 * share * (1.0 - share) / law->full_damping_depth;
}

// r = chi / v0, s/m, of a contact that began with an impact speed, m/s, which is raised to the
// floor.
static inline double force_law_damping_rate(const ForceLaw *law, double impact_speed)
{
    return law->hysteresis / fmax(impact_speed, law->impact_speed_floor);
}

// What the law makes of a depth, by what it has there, and of the depth's rate: the force, which
// may be negative, and its derivatives. Along a motion with the second rate d'' the force changes
// by by_depth d' + by_rate d''. Nothing else has this formula.
//     N = F_el (1 + r d') + c d'
typedef struct ForceLawDamped {
    double force;    // N
    double by_depth; // N/m
    double by_rate;  // N s/m: the damping coefficient
} ForceLawDamped;

// What a law has at a depth.
typedef struct ForceLawTerms {
    double elastic;       // N, F_el
    double tangent;       // N/m, its slope
    double viscous;       // N s/m, c
    double viscous_slope; // N s/m^2
} ForceLawTerms;

static inline ForceLawDamped force_law_damped(ForceLawTerms at, double damping_rate, double closing)
{
    const double rise = 1.0 + damping_rate * closing;
    return (ForceLawDamped){
        .force = at.elastic * rise + at.viscous * closing,
        .by_depth = at.tangent * rise + at.viscous_slope * closing,
        .by_rate = at.elastic * damping_rate + at.viscous,
    };
}

// How fast that force changes, N/s, along a motion whose depth has a second rate, m/s^2.
static inline double force_law_damped_rate(ForceLawTerms at, double damping_rate, double closing,
                                           double second)
{
    const double rise = 1.0 + damping_rate * closing;
    return at.tangent * closing * rise + at.viscous_slope * closing * closing +
           (at.elastic * damping_rate + at.viscous) * second;
}

// The damping coefficient, N s/m, at a penetration, m, in a contact that began with an impact
// speed, m/s.
double force_law_damping(const ForceLaw *law, double penetration, double impact_speed);

// The whole force, N: elastic and damping, never below 0; 0 without penetration.
double force_law_force(const ForceLaw *law, double penetration, double rate, double impact_speed);

// Static penetration, m, under a force, N; 0 where the force is not positive; NaN above the force
// at the depth limit.
double force_law_penetration(const ForceLaw *law, double force);

// Elastic energy stored at a penetration, J.
double force_law_energy(const ForceLaw *law, double penetration);

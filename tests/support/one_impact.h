// One impact of a free pin on its hole's wall, in ODE: what it gives back and how hard it presses.
#pragma once

#include "model/scenario.h"

extern const double ONE_IMPACT_MASS;      // kg
extern const double ONE_IMPACT_SPEED;     // m/s
extern const double ONE_IMPACT_CLEARANCE; // m, which the pin flies across
extern const double ONE_IMPACT_HERTZ;     // N/m^1.5

// The pin at the default laws, stepped as the map needs it: midpoint, exact and impulse are maps of
// staggered stepping.
Scenario one_impact_pin(OdeMap map);

// On a linear spring of 1e7 N/m, with the damper that gives the restitution asked for.
Scenario one_impact_linear(OdeMap map, double asked);

// On F = K d^1.5, K = ONE_IMPACT_HERTZ, with a hysteretic damping law.
Scenario one_impact_hertz(OdeMap map, DampingKind damping, double asked);

// How long the contact of one of the two lasts without its damping, s.
double one_impact_duration(const Scenario *scenario);

// The restitution, 1, that the law of one of the two gives, and its largest force, N.
double one_impact_law_restitution(const Scenario *scenario);
double one_impact_law_force(const Scenario *scenario);

// What an impact in ODE gave: means over sixteen phases, the accident of where the steps fall.
typedef struct OneImpact {
    double restitution;   // 1
    double force_max;     // N
    bool is_single;       // no run failed, nor saw more or less than one contact
    size_t fallback_rows; // of all runs, where the map would not have been stable
} OneImpact;

// For steps that the pin does not fly across its hole in, some milliseconds.
OneImpact one_impact_run(Scenario scenario, double step_s);

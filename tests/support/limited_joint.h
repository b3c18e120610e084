// One impact of a body, a pair of gears or a rack on a flank or stop of a joint's coordinate in
// ODE: how far it is off the law.
#pragma once

#include "base/lcg.h"
#include "model/coordinate.h"
#include "model/scenario.h"

typedef enum LimitedKind {
    LIMITED_HINGE_STOP,
    LIMITED_HINGE_BACKLASH,
    LIMITED_SLIDER_STOP,
    LIMITED_SLIDER_BACKLASH,
    LIMITED_GEARS,
    LIMITED_RACK,
    LIMITED_KINDS,
} LimitedKind;

typedef struct LimitedImpact {
    LimitedKind kind;
    bool is_high;     // which end it meets
    double inertia;   // kg m^2 or kg, as the coordinate has it
    double speed;     // rad/s or m/s
    double stiffness; // N m/rad or N/m
    double restitution;
    double step;   // s
    double flight; // rad or m, to the end
} LimitedImpact;

// Draws an impact with at least so many steps in its contact, and up to `ratio` times as many, and
// a restitution from `least` to 1.
LimitedImpact limited_impact_draw(uint64_t *random, LimitedKind kind, double fewest, double ratio,
                                  double least);

// The scenario of an impact; for scenario_free.
Scenario limited_impact_scenario(const LimitedImpact *impact, OdeStepping stepping, OdeMap map,
                                 OdeSolver solver);

// By how much they are off, of what the law gives. NaN where a run fails or has not one impact.
typedef struct LimitedOff {
    double restitution;
    double force;
    double depth;
} LimitedOff;

LimitedOff limited_impact_run(const LimitedImpact *impact, OdeStepping stepping, OdeMap map,
                              OdeSolver solver);

// The larger of both, number by number; NaN where one of them is.
LimitedOff limited_worse(LimitedOff a, LimitedOff b);

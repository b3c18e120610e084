// The pin of one_impact.h flying along x against the wall, by itself, for contact/encounter.h.
#pragma once

#include "close.h"
#include "one_impact.h"

#include "contact/damping.h"
#include "contact/encounter.h"

static const double LONE_PIN_GAP = 1e-5;   // m, to the wall at the start: 20 us of flight
static const double LONE_PIN_PHASE = 0.05; // rad, the program's default

// F = K d^1.5 (1 + chi d'/v0).
static inline ForceLaw lone_pin_hertz(double chi)
{
    ForceLaw law = force_law_power(ONE_IMPACT_HERTZ, 1.5);
    law.hysteresis = chi;
    return law;
}

static inline Encounter lone_pin(ForceLaw law, double phase)
{
    Encounter encounter = encounter_start(0.0, 5e-3, phase);
    const EncounterJoint joint = {
        .law = law,
        .radial_clearance = ONE_IMPACT_CLEARANCE,
        .hole_radius = ONE_IMPACT_CLEARANCE + 5e-3,
    };
    encounter_add(&encounter, &joint, ENCOUNTER_ROWS_PLAIN);
    encounter.mobility[0] = encounter.mobility[3] = 1.0 / ONE_IMPACT_MASS;
    encounter.position[0] = ONE_IMPACT_CLEARANCE - LONE_PIN_GAP;
    encounter.speed[0] = ONE_IMPACT_SPEED;
    return encounter;
}

// The undamped impact's closed forms: depth, m, and duration, s, 2.943275 d / v.
static inline double lone_pin_depth(void)
{
    return pow(5.0 * ONE_IMPACT_MASS * ONE_IMPACT_SPEED * ONE_IMPACT_SPEED /
                   (4.0 * ONE_IMPACT_HERTZ),
               0.4);
}

static inline double lone_pin_duration(void)
{
    return 2.0 * sqrt(acos(-1.0)) * tgamma(1.4) / tgamma(0.9) * lone_pin_depth() / ONE_IMPACT_SPEED;
}

// The sums at the end of what has run, and a row's speed there.
static inline EncounterSums lone_pin_end(const Encounter *encounter)
{
    EncounterSums sums;
    const size_t last = encounter->node_count - 1;
    encounter_at(encounter, last, encounter->times[last], &sums);
    return sums;
}

static inline double lone_pin_speed_after(const Encounter *encounter)
{
    return ONE_IMPACT_SPEED + lone_pin_end(encounter).impulse[0] / ONE_IMPACT_MASS;
}

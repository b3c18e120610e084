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
    Encounter encounter = encounter_start(phase);
    const EncounterJoint joint = {
        .law = law,
        .radial_clearance = ONE_IMPACT_CLEARANCE,
        .hole_radius = ONE_IMPACT_CLEARANCE + 5e-3,
    };
    encounter_add(&encounter, &joint, ENCOUNTER_ROWS_PLAIN);
    encounter_make_room(&encounter, encounter.row_count);
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

enum { LONE_PIN_ROWS = 9 };

// An encounter's sums at a time, by themselves.
typedef struct PinSums {
    double impulse[LONE_PIN_ROWS];    // N s
    double moment[2 * LONE_PIN_ROWS]; // N s^2, then N s^3
    double force[LONE_PIN_ROWS];      // N
    double dissipated;                // J
    double friction;                  // J
} PinSums;

static inline void pin_sums_at(const Encounter *encounter, size_t node, double time_s,
                               PinSums *sums)
{
    EncounterSums found = {.impulse = sums->impulse, .moment = sums->moment, .force = sums->force};
    assert_true(encounter_rows(encounter) <= LONE_PIN_ROWS);
    encounter_at(encounter, node, time_s, &found);
    sums->dissipated = found.dissipated;
    sums->friction = found.friction;
}

// How a joint is then.
static inline EncounterPose pin_pose_at(const Encounter *encounter, size_t joint, size_t node,
                                        double time_s)
{
    PinSums sums;
    pin_sums_at(encounter, node, time_s, &sums);
    const EncounterSums at = {.impulse = sums.impulse, .moment = sums.moment, .force = sums.force};
    return encounter_pose(encounter, joint, node, time_s, &at);
}

// The sums at the end of what has run, and a row's speed there.
static inline PinSums lone_pin_end(const Encounter *encounter)
{
    PinSums sums;
    const size_t last = encounter->node_count - 1;
    pin_sums_at(encounter, last, encounter->times[last], &sums);
    return sums;
}

static inline double lone_pin_speed_after(const Encounter *encounter)
{
    return ONE_IMPACT_SPEED + lone_pin_end(encounter).impulse[0] / ONE_IMPACT_MASS;
}

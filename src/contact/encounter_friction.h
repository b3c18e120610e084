// Coulomb's friction, smooth through rest: how much of mu N a contact holds against its sliding,
// with the derivatives.
//
// With v the sliding speed and v_s that at which friction takes hold
//     along a line    tanh(v / v_s),          by v: (1 - tanh^2) / v_s
//     in a plane      phi(s) (v_x, v_y),      phi = tanh(s / v_s) / s,  s = |(v_x, v_y)|
//     d phi = phi' / s (v_x dv_x + v_y dv_y), phi' / s = ((1 - tanh^2) / v_s - phi) / s^2
// and near rest by the series phi = 1 / v_s - s^2 / (3 v_s^3).
#pragma once

#include <math.h>

// of v_s: sliding below which differences of the closed form would be rounding
static const double ENCOUNTER_FRICTION_SLOW = 1e-4;

typedef struct EncounterHold {
    double held;  // 1
    double slope; // s/m
} EncounterHold;

static inline EncounterHold encounter_friction_hold(double sliding, double speed)
{
    const double held = tanh(sliding / speed);
    return (EncounterHold){held, (1.0 - held * held) / speed};
}

typedef struct EncounterGrip {
    double share; // s/m: phi
    double bend;  // s^3/m^3: phi' / s
} EncounterGrip;

static inline EncounterGrip encounter_friction_grip(double size, double speed)
{
    if (size < ENCOUNTER_FRICTION_SLOW * speed) {
        return (EncounterGrip){1.0 / speed, -2.0 / (3.0 * speed * speed * speed)};
    }
    const EncounterHold hold = encounter_friction_hold(size, speed);
    const double share = hold.held / size;
    return (EncounterGrip){share, (hold.slope - share) / (size * size)};
}

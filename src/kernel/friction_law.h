// Coulomb's friction, smooth through rest: how much of mu N a contact holds against its sliding,
// with the derivatives.
//
// With v the sliding speed and v_s that at which friction takes hold
//     along a line    tanh(v / v_s),          by v: (1 - tanh^2) / v_s
//     in a plane      phi(s) (v_x, v_y),      phi = tanh(s / v_s) / s,  s = |(v_x, v_y)|
//     d phi = phi' / s (v_x dv_x + v_y dv_y), phi' / s = ((1 - tanh^2) / v_s - phi) / s^2
// whose phi' / s near rest is that of the series phi = 1 / v_s - s^2 / (3 v_s^3). It is meant for
// any solver: nothing else has the law.
#pragma once

#include <math.h>

// of v_s: sliding below which the difference in phi' would be rounding
static const double FRICTION_SERIES_BELOW = 1e-4;

typedef struct FrictionHold {
    double held;  // 1
    double slope; // s/m
} FrictionHold;

static inline FrictionHold friction_hold(double sliding, double speed)
{
    const double held = tanh(sliding / speed);
    return (FrictionHold){held, (1.0 - held * held) / speed};
}

typedef struct FrictionGrip {
    double share; // s/m: phi
    double bend;  // s^3/m^3: phi' / s
} FrictionGrip;

static inline FrictionGrip friction_grip(double size, double speed)
{
    const FrictionHold hold = friction_hold(size, speed);
    const double share = size > 0.0 ? hold.held / size : 1.0 / speed;
    return (FrictionGrip){
        .share = share,
        .bend = size < FRICTION_SERIES_BELOW * speed ? -2.0 / (3.0 * speed * speed * speed)
                                                     : (hold.slope - share) / (size * size),
    };
}

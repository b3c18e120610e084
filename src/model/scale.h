// How fast will a scenario move, before it has moved? Sizes for errors and perturbations.
#pragma once

#include "model/scenario.h"

typedef struct SpeedScale {
    double reach;   // m, largest distance of an anchor from its body's centre or the origin
    double moving;  // m/s, of places: above 0
    double turning; // rad/s, of angles: above 0
} SpeedScale;

// The largest of the speeds at the start, of the driver's at the reach, and of a fall under gravity
// through the reach; 1 m/s where nothing moves and nothing pulls.
SpeedScale scale_speeds(const Scenario *scenario);

// How much do accelerations and forces vary without any play? What stands out further is a spike.
#pragma once

#include "model/scenario.h"

typedef struct SpikeScale {
    bool is_known; // false: nothing drives, or the ideal linkage does not go all the way round
    double alpha;  // rad/s^2: above 0
    double force;  // N: above 0
} SpikeScale;

// Sizes in a turn of the driver with every joint ideal, over all bodies and joints: the largest
// range of an angular acceleration, or the square of the driver's speed where that is more, and the
// largest force.
SpikeScale spike_scale(const Scenario *scenario);

// What a mechanism does when every joint is ideal: the scale of what play adds to it.
#pragma once

#include "model/scenario.h"

// Sizes in a turn of the driver, or in the run where its speed is not constant.
typedef struct IdealSizes {
    bool is_known;       // false: nothing drives, the ideal linkage does not go all the way round,
                         // or it has no plane
    double *alpha_max;   // rad/s^2, by body: largest size; owned, as the two below
    double *alpha_range; // rad/s^2, by body: from the least to the most
    double *force_max;   // N, by joint: largest size
    double torque_max[LINKAGE_DRIVE_MAX]; // N m, of each drive: largest size
} IdealSizes;

IdealSizes ideal_sizes(const Scenario *scenario);
void ideal_sizes_free(IdealSizes *sizes);

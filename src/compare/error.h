// How far is one trajectory from another that is taken as the truth?
#pragma once

#include "model/trajectory.h"

typedef struct TrajectoryError {
    bool is_known;       // false: there was no reference, or the two have no samples in common
    const char *against; // name of the reference's backend: lives as long as it
    double omega_max;    // 1: largest |omega - omega_ref| over all moving bodies that are not
                         // driven and all samples, each over that body's largest |omega_ref|
    double omega_max_time_s;
    double omega_rms;     // 1: root of the mean square of the same
    double alpha_max;     // 1: as omega_max, of the angular acceleration
    double angle_max_rad; // largest |angle - angle_ref|
} TrajectoryError;

// Both trajectories must be of the same scenario: same bodies, same sample times.
TrajectoryError error_against(const Trajectory *trajectory, const Trajectory *reference);

// How far is one trajectory from another that is taken as the truth?
//
// In omega and alpha; where no drive turns anything, in the velocities and accelerations of the
// bodies' centres instead.
#pragma once

#include "model/distance.h"
#include "model/trajectory.h"

// Errors below this multiple of the reference's uncertainty are dominated by it.
static const double ERROR_CLEAR_OF_TRUTH = 10.0;

typedef struct TrajectoryError {
    bool is_known;       // false: there was no reference, or the two have no samples in common
    const char *against; // name of the reference's backend: lives as long as it
    double omega_max;    // 1: largest |omega - omega_ref| over all moving bodies that are not
                         // driven and all samples, each over that body's largest |omega_ref|
    double omega_max_time_s;
    double omega_max_in_horizon; // 1: as omega_max, up to the horizon; NAN without a sample in it
    double omega_rms;            // 1: root of the mean square of the same, whole run
    double alpha_max;            // 1: as omega_max, of the angular acceleration
    double angle_max_rad;        // largest |angle - angle_ref|
} TrajectoryError;

// Both trajectories must be of the same scenario: same bodies, same sample times. The horizon, s,
// is the time up to which trajectories may be compared; INFINITY where nothing limits it.
TrajectoryError error_against(const Trajectory *trajectory, const Trajectory *reference,
                              double horizon_s);

// The same measure sample by sample: writes the largest difference in omega over the bodies at each
// sample, relative to scales, by body, into an array of the trajectories' length. The scales are
// mostly those of the reference. Returns false, the array untouched, where the two cannot be
// compared.
bool error_series(const Trajectory *trajectory, const Trajectory *reference,
                  const DistanceScale *scales, double *omega);

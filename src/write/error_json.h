// The numbers of an error as JSON, alike wherever one is written.
#pragma once

#include "measure/error.h"

#include <jansson.h>

// Puts omega_max, omega_max_time_s, omega_max_in_horizon, omega_rms, alpha_max and angle_max_rad
// into the object.
void error_json_set(json_t *object, const TrajectoryError *error);

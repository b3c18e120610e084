// One trajectory as a table of numbers: a row a sample, for other programs to read.
#pragma once

#include "model/trajectory.h"

#include <stdio.h>

// Writes the series to a file, whole or not at all. Columns: time_s, crank_deg, then of each body
// <body>_angle_rad, <body>_omega_rad_s, <body>_alpha_rad_s2, of each joint <joint>_ex_m,
// <joint>_ey_m, <joint>_gap_m, <joint>_force_N, of each traced point <point>_x_m, <point>_y_m.
// Numbers have 17 significant digits. The trajectory must be complete.
bool series_csv_write(const Scenario *scenario, const Trajectory *trajectory, const char *path,
                      Err *err);

// The name of one run's file: FILE.csv stays as it is where it is the only run, and becomes
// FILE-<backend>.csv where there are several. Cut if it is too long for the buffer.
void series_csv_path(const char *path, const char *backend, size_t run_count, char *target,
                     size_t size);

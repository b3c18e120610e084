// N four-bars in a row, problem A02 of the IFToMM benchmark library of multibody dynamics: uniform
// links of 1 m and 1 kg, started upright with 1 m/s at their tips.
//
// On the branch of parallelograms all uprights stand at one angle theta from the vertical:
//     theta'' = k sin theta,   k = g 3 (3 N + 1) / (2 (4 N + 1)),   theta(0) = 0, theta'(0) = 1
// At every change point, where the couplers meet the ground, other branches begin.
#pragma once

#include "model/trajectory.h"

// Fills a scenario whose linkage has room for 2 N + 1 bodies and 3 N + 1 joints. Uprights have the
// even numbers and point up; couplers the odd ones.
void four_bars_fill(Scenario *scenario, size_t count, double duration_s);

// An upright's angle from the vertical and its rate.
typedef struct FourBarsAngle {
    double theta; // rad, clockwise
    double rate;  // rad/s
} FourBarsAngle;

// At a time, to some 1e-13 after ten seconds.
FourBarsAngle four_bars_angle(size_t count, double time_s);

// How far the tip of any upright is from where theta has it, m, at the end of a run.
double four_bars_error(const Trajectory *run, double theta);

// How far any upright is turned against the first, rad, at any sample: some 1 and more once a run
// has left the branch of parallelograms.
double four_bars_spread(const Trajectory *run);

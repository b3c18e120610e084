// The truth as a trajectory, to be compared like any other.
#pragma once

#include "model/trajectory.h"
#include "quad_truth.h"

// Integrates the problem to the scenario's samples up to a time, s; what lies behind the last
// sample reached (figures) is zero. The caller destroys it.
Trajectory *truth_trajectory(const Scenario *scenario, const QuadProblem *problem,
                             const TruthOptions *options, double until_s, TruthFigures *figures);

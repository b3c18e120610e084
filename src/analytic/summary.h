// What the closed form says of a four-bar over one turn of its crank.
#pragma once

#include "model/trajectory.h"

typedef struct AnalyticSummary {
    GrashofClass grashof;
    double transmission_low;  // rad, smallest acute angle between coupler and follower
    double transmission_high; // rad
    double transmission_low_crank;
    double transmission_high_crank;
    double follower_low;   // rad, the swing of the follower
    double follower_high;  // rad
    bool has_limits;       // whether the follower swings between two dead centres
    double limit_extended; // rad, crank angle where crank and coupler stretch out in one line
    double limit_folded;   // rad, crank angle where they fold over one another
    Extreme torque_max;    // N m, of the drive
    Extreme torque_min;
    Extreme reaction_max[LINKAGE_JOINT_MAX]; // N, size of the force in each joint, taken as ideal
    Extreme reaction_min[LINKAGE_JOINT_MAX];
    double power_residual; // 1: largest |torque speed - power| over the largest |torque speed|
} AnalyticSummary;

// Fails with ERR_SOLVER where the scenario is no four-bar or its crank does not turn fully.
bool summary_compute(const Scenario *scenario, AnalyticSummary *summary, Err *err);

// What the closed form says of a four-bar or a slider-crank over one turn of its crank.
#pragma once

#include "analytic/curve.h"
#include "model/kinematics.h"
#include "model/trajectory.h"

typedef struct AnalyticSummary {
    GrashofClass grashof;     // of a four-bar
    double transmission_low;  // rad, smallest acute angle between coupler and follower, or between
                              // rod and the normal of the slider's line
    double transmission_high; // rad
    double transmission_low_crank;
    double transmission_high_crank;
    double follower_low;       // rad, the swing of the follower
    double follower_high;      // rad
    CurveExtreme slide;        // m, of a slider along its line
    CurveExtreme velocity;     // m/s, likewise
    CurveExtreme acceleration; // m/s^2
    bool has_limits;           // whether follower or slider goes between two dead centres
    double limit_extended;     // rad, crank angle where crank and coupler stretch out in one line
    double limit_folded;       // rad, crank angle where they fold over one another
    Extreme torque_max;        // N m, of the drive
    Extreme torque_min;
    Extreme
        reaction_max[KINEMATICS_JOINT_MAX]; // N, size of the force in each joint, taken as ideal
    Extreme reaction_min[KINEMATICS_JOINT_MAX];
    double power_residual; // 1: largest |torque speed - power| over the largest |torque speed|
} AnalyticSummary;

// Fails with ERR_SOLVER where the scenario has no closed form or its crank does not turn fully.
bool summary_compute(const Scenario *scenario, AnalyticSummary *summary, Err *err);

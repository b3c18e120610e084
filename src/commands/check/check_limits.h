// Do the runs of a case keep within the limits that it sets itself?
#pragma once

#include "commands/check/check_judge.h"

enum { CHECK_LIMIT_MAX = EXPECTATION_MAX * BACKEND_COUNT };

// One limit on one backend.
typedef struct CheckLimit {
    char name[LINKAGE_NAME_SIZE + EXPECTATION_PATH_SIZE]; // ode.joints.crank-coupler.force_max
    const Expectation *expectation;                       // of the scenario: lives as long as it
    CheckVerdict verdict; // CHECK_WITHIN, CHECK_OUT, or CHECK_GONE where nothing was measured
    double value;         // SI; NAN where nothing was measured
    double off;           // SI, by how much it is outside; see expect_value.h
} CheckLimit;

// Judges the limits of a scenario by its own start: writes at most CHECK_LIMIT_MAX, in the order of
// the case, and returns their count. A limit that concerns no backend of the case is not measured.
size_t check_limits_judge(const Scenario *scenario, const CheckMeasure *run, CheckLimit *limits);

// What a regression check measures of a scenario: a list of numbers with names.
#pragma once

#include "measure/truth.h"

enum { CHECK_NAME_SIZE = 112, CHECK_METRIC_MAX = 2048, CHECK_MESSAGE_SIZE = 512 };

typedef enum CheckKind {
    CHECK_REAL,
    CHECK_COUNT, // a whole number
    CHECK_HASH,  // of a trajectory: equal or not
} CheckKind;

// One number. Its name says where it is from and what its unit is:
// "ode/coupler/alpha_max_rad_s2", and "ode-to-horizon/..." where the run was cut short at the
// horizon of predictability.
typedef struct CheckMetric {
    char name[CHECK_NAME_SIZE];
    CheckKind kind;
    bool is_slow;  // measured where CheckPlan.is_full
    double value;  // in the unit of its name
    double scale;  // likewise, above 0 or 0: what a spread is a share of
    double floor;  // likewise: what rounding alone may change, whatever an ensemble says
    uint64_t hash; // of CHECK_HASH
} CheckMetric;

typedef struct CheckMeasure {
    bool is_complete; // false: the message says which run failed and why
    char message[CHECK_MESSAGE_SIZE];
    size_t count;
    CheckMetric metrics[CHECK_METRIC_MAX];
    // SI, by expectation of the scenario and by backend; NAN where it was not measured
    double expected[EXPECTATION_MAX][BACKEND_COUNT];
} CheckMeasure;

// What to hold the runs against, and how much to measure. It is settled when a baseline is made:
// a horizon found anew each time would move by a sample for no reason.
typedef struct CheckPlan {
    bool has_truth;     // errors are measured
    double uncertainty; // 1, of the truth
    bool is_limited;    // the motion cannot be predicted to its end
    double horizon_s;   // where that is so
    bool is_full;       // order of convergence as well
} CheckPlan;

// How the starts of an ensemble differ from the scenario's own.
typedef struct CheckStart {
    unsigned member; // 0: not at all
    double share;    // 1: size of the perturbation, see model/perturb.h
    unsigned shake;  // 0: not; else the seed with which inputs are rounded anew
} CheckStart;

// The plan of a scenario, its truth being known. The runs are measured in full.
CheckPlan check_plan(const Truth *truth);

// The scenario from another start.
void check_measure_start(Scenario *scenario, CheckStart start);

// Runs the scenario on its backends and measures them. A run that fails leaves nothing measured.
void check_measure(const Scenario *scenario, const CheckPlan *plan, CheckMeasure *measure);

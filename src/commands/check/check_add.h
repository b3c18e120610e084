// What a regression check measures, a list of numbers with names, and how those of one run get into
// it.
#pragma once

#include "measure/error.h"
#include "model/scale.h"

enum { CHECK_NAME_SIZE = 112, CHECK_MESSAGE_SIZE = 512 };

typedef enum CheckKind {
    CHECK_REAL,
    CHECK_COUNT,  // a whole number
    CHECK_EFFORT, // likewise, of what a solver spent: says nothing of the motion
    CHECK_HASH,   // of a trajectory: equal or not
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
    size_t room;          // of the metrics there is room for
    CheckMetric *metrics; // owned: check_measure_finish
    // SI, by expectation of the scenario and by backend; NAN where it was not measured
    double expected[EXPECTATION_MAX][BACKEND_COUNT];
} CheckMeasure;

// Where numbers are added, and what they are scaled by.
typedef struct CheckAdd {
    const Scenario *scenario;
    CheckMeasure *measure;
    const char *group; // behind the backend's name: "" or "-to-horizon"
    SpeedScale speeds;
    double energy; // J, of everything at the scale of speeds; N m, of a torque that does so
    double force;  // N, which gives everything the acceleration of that scale
} CheckAdd;

// For check_add_end.
CheckAdd check_add_begin(const Scenario *scenario, const char *group, CheckMeasure *measure);
void check_add_end(CheckAdd *work);

// Adds extremes, spikes, contacts, energy and cost of a run.
void check_add_run(CheckAdd *work, const Trajectory *run, BackendKind backend);

// Adds what the error is, against a truth that is known to `uncertainty`, and one order of
// convergence from two errors.
void check_add_error(CheckAdd *work, const Trajectory *run, const TrajectoryError *error,
                     double uncertainty);
void check_add_order(CheckAdd *work, const Trajectory *run, const char *name, double error,
                     double finer);

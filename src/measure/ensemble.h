// Past the horizon of predictability: the same scenario from many starts, as distributions.
#pragma once

#include "run/run.h"

enum { ENSEMBLE_MEMBERS = 16 };

// Size of the differences between the starts: of each body's speeds relative to its own largest.
extern const double ENSEMBLE_PERTURBATION;

// What is compared of a joint with play.
typedef enum EnsembleMetric {
    ENSEMBLE_FORCE_MAX,       // N
    ENSEMBLE_IMPULSE,         // N s
    ENSEMBLE_IMPACTS,         // 1
    ENSEMBLE_PENETRATION_MAX, // m
    ENSEMBLE_CONTACT_SHARE,   // 1
    ENSEMBLE_METRIC_COUNT,
} EnsembleMetric;

typedef struct Distribution {
    double low;    // smallest of the members
    double median; //
    double high;   // largest
    double mean;
    double deviation; // standard deviation
} Distribution;

typedef struct Ensemble {
    size_t members;                                                // complete runs
    size_t failed;                                                 // runs that were not
    char message[ERR_TEXT_SIZE];                                   // of the first failed one
    Distribution joints[LINKAGE_JOINT_MAX][ENSEMBLE_METRIC_COUNT]; // of joints with play
} Ensemble;

// Runs the scenario from ENSEMBLE_MEMBERS starts that differ by ENSEMBLE_PERTURBATION, the first
// one unperturbed.
void ensemble_run(const Scenario *scenario, const Solver *solver, RunWatch watch,
                  Ensemble *ensemble);

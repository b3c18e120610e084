// Past the horizon of predictability: the same scenario from many starts, as distributions.
#pragma once

#include "run/run.h"

// Joints behind the first so many have no distributions.
enum { ENSEMBLE_MEMBERS = 16, ENSEMBLE_JOINT_MAX = 24 };

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
    bool is_beyond_budget;       // none was run, for there was no time for some
    size_t members;              // complete runs
    size_t failed;               // runs that were not
    char message[ERR_TEXT_SIZE]; // of the first failed one
    // of joints with play, by number
    Distribution joints[ENSEMBLE_JOINT_MAX][ENSEMBLE_METRIC_COUNT];
} Ensemble;

// How many joints of a linkage may have distributions.
static inline size_t ensemble_joint_count(const Linkage *linkage)
{
    return linkage->joint_count < ENSEMBLE_JOINT_MAX ? linkage->joint_count : ENSEMBLE_JOINT_MAX;
}

// Runs the scenario from ENSEMBLE_MEMBERS starts that differ by ENSEMBLE_PERTURBATION, the first
// one unperturbed, or from as many of them as a budget allows, s of processor time (0: all). The
// watch is told of all of them as of one run.
void ensemble_run(const Scenario *scenario, const Solver *solver, double budget_s, RunWatch watch,
                  Ensemble *ensemble);

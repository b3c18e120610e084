// The numbers of one run, added to a measure.
#pragma once

#include "commands/check/check_measure.h"
#include "measure/error.h"
#include "model/scale.h"

// Where numbers are added, and what they are scaled by.
typedef struct CheckAdd {
    const Scenario *scenario;
    CheckMeasure *measure;
    const char *group; // behind the backend's name: "" or "-to-horizon"
    SpeedScale speeds;
    double energy; // J, of everything at the scale of speeds
} CheckAdd;

CheckAdd check_add_begin(const Scenario *scenario, const char *group, CheckMeasure *measure);

// Adds extremes, spikes, contacts, energy and cost of a run.
void check_add_run(CheckAdd *work, const Trajectory *run, BackendKind backend);

// Adds what the error is, and one order of convergence from two errors.
void check_add_error(CheckAdd *work, const Trajectory *run, const TrajectoryError *error);
void check_add_order(CheckAdd *work, const Trajectory *run, const char *name, double error,
                     double finer);

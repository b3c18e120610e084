// One case on all of its backends, ready to be reported.
#pragma once

#include "cli/progress.h"
#include "commands/run/run_report.h"

typedef struct CaseRun {
    Scenario scenario;
    bool is_uncertified; // whether the reference runs alone
    Trajectory *runs[BACKEND_COUNT];
    TrajectoryError errors[BACKEND_COUNT];
    AnalyticSummary summary;
    Err summary_err; // why there is none
    Stackup stackup;
    Err stackup_err; // likewise
    Truth truth;     // its trajectory is among the runs where its backend is
    RunMatches matches[BACKEND_COUNT];
    Ensemble ensembles[BACKEND_COUNT];
    RunReport report; // points into this CaseRun, which must not be moved
    size_t failed_count;
} CaseRun;

// Runs the scenario that stands in it, with the reference certified unless it is to run alone, on
// the processors that there are, and from many starts where the motion cannot be predicted; every
// run is watched. A backend that fails is a run that is not complete, and counted.
void case_run_execute(CaseRun *run, Progress *progress);

void case_run_finish(CaseRun *run);

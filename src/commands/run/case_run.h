// One case on all of its backends, ready to be reported: by commands, and by the library of cases.
#pragma once

#include "commands/run/run_report.h"
#include "measure/chosen_run.h"

// Who watches a case being run.
typedef struct CaseWatch {
    // Watches the runs that follow, which do that.
    ChosenWatch (*begin)(const char *doing, void *context);
    // They are over; others may follow.
    void (*end)(void *context);
    // Asked once the start is found, before anything runs; NULL: nobody wants to know.
    void (*settled)(const Scenario *scenario, void *context);
    void *context;
} CaseWatch;

typedef struct CaseRun {
    Scenario scenario;
    bool is_uncertified; // whether the reference runs alone
    bool is_whole;       // whether somebody reads more of it than the first screen
    bool is_quick;       // whether nothing beside the runs is looked at
    const char *path;    // as given; not owned, as the two below
    SpreadCase as_read;  // what it was loaded from; without a text where that is read once more
    const char *columns; // of the series, as --columns takes them; NULL: all
    Trajectory *runs[BACKEND_COUNT];
    TrajectoryError errors[BACKEND_COUNT];
    AnalyticSummary summary;
    Err summary_err; // why there is none
    Stackup stackup;
    Err stackup_err; // likewise
    Truth truth;     // its trajectory is among the runs where its backend is
    RunMatches matches[BACKEND_COUNT];
    Ensemble ensembles[BACKEND_COUNT];
    Spread spread;
    double
        spent_s[BACKEND_COUNT]; // of processor time by each backend, but for starts beside its run
    RunReport report;           // points into this CaseRun, which must not be moved
    size_t failed_count;
    // Called with a report of the reference alone as soon as there is one; NULL: nobody waits.
    void (*answered)(const RunReport *report, void *listener);
    void *listener;
} CaseRun;

// Whether the scenario that stands in it can be run so, asked before any work. Fails with ERR_USAGE
// where one that runs the reference alone has a step that is chosen by its error, and with ERR_CASE
// where a backend cannot run it.
bool case_run_check(const CaseRun *run, Err *err);

// Runs the scenario that stands in it, with the reference certified unless it is to run alone, on
// the processors that there are, and, where somebody reads of it, from many starts where the motion
// cannot be predicted; every run is watched. A backend that fails is a run that is not complete,
// and counted.
void case_run_execute(CaseRun *run, const CaseWatch *watch);

void case_run_finish(CaseRun *run);

// One case on all of its backends, ready to be reported.
#pragma once

#include "cli/common_options.h"
#include "cli/progress.h"
#include "commands/run/run_report.h"

typedef struct CaseRun {
    Scenario scenario;
    bool is_uncertified;          // whether the reference runs alone
    bool is_whole;                // whether somebody reads more of it than the first screen
    bool is_quick;                // whether nothing beside the runs is looked at
    const CommonOptions *options; // that it was loaded by; not owned
    const char *path;             // likewise, as given
    const char *columns;          // of the series, as --columns takes them; NULL: all
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

// Runs the scenario that stands in it, with the reference certified unless it is to run alone, on
// the processors that there are, and, where somebody reads of it, from many starts where the motion
// cannot be predicted; every run is watched. A backend that fails is a run that is not complete,
// and counted.
void case_run_execute(CaseRun *run, Progress *progress);

void case_run_finish(CaseRun *run);

// What `jointplay run` writes of each run: a file for each backend.
typedef enum RunTable {
    RUN_SERIES,   // a row a sample: write/series_rows.h; --series
    RUN_CONTACTS, // a row a contact: write/contact_table.h, of runs that keep them; --contacts
} RunTable;

// Whether the series has the columns that are chosen, before the case is run. Fails with ERR_USAGE.
bool run_files_check_columns(const CaseRun *run, Err *err);

// Claims the files of a table, before the case is run. Leaves nothing behind. Fails as
// row_file_claim does.
bool run_files_claim(const CaseRun *run, RunTable table, const char *path, Err *err);

// Writes the table of every run that is complete: to the path itself where the case has one
// backend, and to FILE-<backend>.csv for each where it has several. ERR_FILE.
bool run_files_write(const CaseRun *run, RunTable table, const char *path, bool is_quiet, Err *err);

// Likewise, <case>-<backend>.csv in the folder of --out, which is there; with play the contacts in
// <case>-<backend>-contacts.csv as well.
bool run_files_claim_folder(const CaseRun *run, const CommonOptions *options, Err *err);
bool run_files_folder(const CaseRun *run, const CommonOptions *options, Err *err);

// Writes the series to a file, whole or not at all, in the form that its name asks for: the columns
// of write/series_rows.h, or those of them that the patterns choose (NULL: all). The trajectory
// must be complete.
bool series_write(const Scenario *scenario, const Trajectory *trajectory, const char *patterns,
                  const char *path, Err *err);

// The name of one run's file: FILE.csv stays as it is where it is the only run, and becomes
// FILE-<backend>.csv where there are several. Cut if it is too long for the buffer.
void series_path(const char *path, const char *backend, size_t run_count, char *target,
                 size_t size);

// The files that the runs of a case leave behind, what is shown meanwhile, and their names.
#pragma once

#include "cli/common_options.h"
#include "cli/progress.h"
#include "commands/run/case_run.h"

// Shows how far a case has come on a line that must outlive it, and warns of long work.
CaseWatch run_files_watch(Progress *progress);

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

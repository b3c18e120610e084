// The files that `jointplay run` leaves behind.
#pragma once

#include "commands/run/case_run.h"

// Writes the series of every run that is complete: to the path itself where the case has one
// backend, and to FILE-<backend>.csv for each where it has several. ERR_FILE.
bool run_files_series(const CaseRun *run, const char *path, bool is_quiet, Err *err);

// Claims series and picture, each a path or NULL, before the case is run. Leaves nothing behind.
// Fails as file_claim does.
bool run_files_claim(const CaseRun *run, const char *series, const char *plot, Err *err);

// Writes the picture. ERR_FILE.
bool run_files_plot(const CaseRun *run, const char *path, bool is_quiet, Err *err);

// As run_files_claim, of all that run_files_folder writes; the folder is there.
bool run_files_claim_folder(const CaseRun *run, const char *folder, Err *err);

// Writes <case>.json, <case>.txt, <case>.svg and a <case>-<backend>.csv a complete run into the
// folder. ERR_FILE.
bool run_files_folder(const CaseRun *run, const char *folder, bool is_quiet, Err *err);

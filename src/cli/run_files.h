// The files that `jointplay run` leaves behind.
#pragma once

#include "cli/case_run.h"

// Writes the series of every run that is complete: to the path itself where the case has one
// backend, and to FILE-<backend>.csv for each where it has several. ERR_FILE.
bool run_files_series(const CaseRun *run, const char *path, bool is_quiet, Err *err);

// Writes the picture. ERR_FILE.
bool run_files_plot(const CaseRun *run, const char *path, bool is_quiet, Err *err);

// Makes the folder, and those it stands in, where they are missing. ERR_FILE.
bool run_files_make_folder(const char *folder, Err *err);

// Writes <case>.json, <case>.txt, <case>.svg and a <case>-<backend>.csv a complete run into the
// folder. ERR_FILE.
bool run_files_folder(const CaseRun *run, const char *folder, bool is_quiet, Err *err);

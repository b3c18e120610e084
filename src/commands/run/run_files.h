// The series of `jointplay run`: a file for each backend.
#pragma once

#include "cli/common_options.h"
#include "commands/run/case_run.h"

// Claims the files of the series, before the case is run. Leaves nothing behind. Fails as
// file_claim does.
bool run_files_claim(const CaseRun *run, const char *series, Err *err);

// Writes the series of every run that is complete: to the path itself where the case has one
// backend, and to FILE-<backend>.csv for each where it has several. ERR_FILE.
bool run_files_series(const CaseRun *run, const char *path, bool is_quiet, Err *err);

// Likewise, <case>-<backend>.csv in the folder of --out, which is there.
bool run_files_claim_folder(const CaseRun *run, const CommonOptions *options, Err *err);
bool run_files_folder(const CaseRun *run, const CommonOptions *options, Err *err);

// The files that `jointplay tune` leaves behind.
#pragma once

#include "commands/tune/tune_options.h"
#include "commands/tune/tune_report.h"

// Whether all files asked for could be written now, before the search. Leaves nothing behind.
// ERR_FILE.
bool tune_files_claim(const Scenario *scenario, const TuneOptions *options, Err *err);

// Writes what the options ask for: C code, SDF, MJCF, and all of it with tables and JSON into the
// folder. What there is nothing to say of is not written, and said to be so. ERR_FILE.
bool tune_files_write(const TuneReport *report, const TuneOptions *options, Err *err);

// The files that `jointplay compare` leaves behind.
#pragma once

#include "commands/compare/compare_options.h"
#include "commands/compare/compare_report.h"

// Whether all of that can be written, before anything runs. Leaves nothing behind; the folder is
// there. ERR_FILE.
bool compare_files_claim(const Scenario *scenario, const CompareOptions *options, Err *err);

// Writes what the options name: the points, the picture, the folder. ERR_FILE.
bool compare_files_write(const CompareReport *report, const CompareOptions *options, Err *err);

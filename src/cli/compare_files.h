// The files that `jointplay compare` leaves behind.
#pragma once

#include "cli/compare_options.h"
#include "report/compare_report.h"

// Writes what the options name: the points, the picture, the folder. ERR_FILE.
bool compare_files_write(const CompareReport *report, const CompareOptions *options, Err *err);

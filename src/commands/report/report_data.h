// What a report carries for its script: the mechanism, the results of its runs, and their signals.
#pragma once

#include "commands/run/run_report.h"

// Appends all of it, packed (report_pack.h). The JSON in it is
//     {"format", "title", "case", "command", "results": as `jointplay run --json` prints,
//      "crank": {"speed_rad_s", "start_rad"} or null, "duration_s", "report_from_s", "horizon_s",
//      "bodies", "joints", "springs", "points",
//      "runs": [{"backend", "label", "is_truth", "from_s", "interval_s", "stride", "signals",
//                "marks" (report_marks.h), "peaks", "spikes"}]}
// with a signal's name as that of a column of `jointplay run --series`. Of a run with more samples
// than there is room for, every stride-th is kept; columns of smallest and largest values between
// samples then hold those of all that were left out.
// The size of the page's picture, in bytes, leaves less or more room for samples.
void report_data_write(const RunReport *report, const char *command, size_t picture_size,
                       Text *text);

// What would the reference cost for the error asked for, without ODE?
#pragma once

#include "commands/tune/tune_report.h"
#include "commands/tune/tune_runs.h"

// Searches for the loosest reference.tolerance that meets the target, the next tighter one as well,
// and times it. Finds none where the truth's own tolerance would be needed.
bool tune_reference_run(const TuneSearch *search, Err *err);

// Appends the tolerance, its error, its cost beside the cheapest setting's, and its keys; nothing
// where there is none.
void tune_reference_write(const TuneReport *report, const Style *style, Text *text);

// The same for other programs; null where there is none.
json_t *tune_reference_object(const TuneReport *report);

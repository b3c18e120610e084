// Searches for the cheapest setting.
#pragma once

#include "commands/tune/tune.h"
#include "commands/tune/tune_runs.h"

// Makes the truth and searches: always the cheapest setting that is left, until what is left costs
// more than the best that meets the target. Then the plain rows on their own, the finest steps
// within the limit, the timing runs, and the linear contact. At a step that is held each scheme is
// run once, and only where none of them meets the target the longest step that does is searched.
// Fails with ERR_SOLVER where there is no truth, with ERR_USAGE where the target is too close to
// its uncertainty.
bool tune_search_execute(const TuneSearch *search, Err *err);

// The cost of the reference for the error asked for, without ODE.

// Appends the tolerance, its error, its cost beside the cheapest setting's, and its keys; nothing
// where there is none.
void tune_reference_write(const TuneReport *report, const Style *style, Text *text);

// The same for other programs; null where there is none.
json_t *tune_reference_object(const TuneReport *report);

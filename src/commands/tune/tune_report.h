// Everything there is to tell about a search for the cheapest setting: plain pointers, nothing
// owned.
#pragma once

#include "commands/tune/tune.h"

typedef struct TuneReport {
    const Scenario *scenario;
    const Tune *tune;             // concluded
    const char *const *overrides; // that were given with --set
    size_t override_count;
    double time_limit_s; // of one run
} TuneReport;

// Whether the error asked for is met by a setting that costs no more than what was allowed, or at
// the step that is held.
static inline bool tune_report_is_met(const TuneReport *report)
{
    const TuneTrial *best = tune_best(report->tune, report->tune->winner);
    if (report->tune->held_s > 0.0) {
        return tune_is_met_held(report->tune);
    }
    return best != NULL && tune_is_within(report->tune, best);
}

// Whether a cost was set that nothing may exceed.
static inline bool tune_report_has_limit(const TuneReport *report)
{
    return report->tune->limit.steps > 0 || report->tune->limit.time_s > 0.0;
}

// Everything there is to tell about a search for the cheapest setting: plain pointers, nothing
// owned.
#pragma once

#include "base/text.h"
#include "commands/tune/tune.h"
#include "write/style.h"

#include <jansson.h>

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

// Each is of a TuneReport: for other programs, a new reference; and for people.
json_t *tune_json_build(const void *report);
void tune_text_write(const void *report, const Style *style, Text *text);

// What can be had at a step that is held, for people.

// Appends the best setting at the step, whether it meets the error, the longest step that does
// where it does not, and every scheme at the step.
void tune_held_text_answer(const TuneReport *report, const Style *style, Text *text);

// Appends the constants that were run in the whole mechanism, each with its error.
void tune_held_text_constants(const TuneReport *report, const Style *style, Text *text);

// Appends what one ERP and one CFM for all depths come to.
void tune_held_text_row(const Tune *tune, Text *text);

// Fails with ERR_DIFFERS: nothing at the step meets the error, how near it comes, and the longest
// step that does.
bool tune_held_text_unmet(const TuneReport *report, Err *err);

// Where constants come from, such as "law at 1.2 um".
void tune_held_text_source(const TuneReport *report, const TuneLinear *linear, Text *text);

// The tables of a run: what the bodies did, what the joints felt, at what cost.
#pragma once

#include "base/text.h"
#include "commands/run/run_report.h"
#include "write/style.h"

// Extremes of omega and alpha of each body that is not driven, one row a backend.
void run_tables_extremes(const RunReport *report, const Style *style, Text *text);

// The contacts of each joint with play, one row a backend; nothing where no joint has play.
void run_tables_contacts(const RunReport *report, const Style *style, Text *text);

// At most `limit` of the strongest contacts of each joint with play, of the last backend that has
// any.
void run_tables_spikes(const RunReport *report, size_t limit, const Style *style, Text *text);

// Steps and time, and the message of each run that failed.
void run_tables_cost(const RunReport *report, const Style *style, Text *text);

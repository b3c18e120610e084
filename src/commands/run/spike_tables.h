// The spikes of a run's accelerations and forces, for people.
#pragma once

#include "base/text.h"
#include "commands/run/run_report.h"
#include "write/style.h"

// How many each signal has, one row a backend, and of a four-bar how many in the paper's bands; at
// most `limit` of the strongest of each body, of the last backend that looked for any. Nothing
// where none did.
void spike_tables_write(const RunReport *report, size_t limit, const Style *style, Text *text);

// What of a run is best read as a table, as HTML that needs no script: where its energy went, and
// how its motion repeats.
#pragma once

#include "commands/run/run_report.h"

void report_numbers_write(const RunReport *report, Text *html);

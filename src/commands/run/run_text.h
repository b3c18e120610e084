// What `jointplay run` prints for people.
#pragma once

#include "base/text.h"
#include "commands/run/run_report.h"
#include "write/style.h"

enum { RUN_TEXT_SPIKES = 5 }; // contacts listed of each joint, spikes of each body

// The whole report: what was run and how it was modelled, then the tables.
void run_text_write(const RunReport *report, const Style *style, Text *text);

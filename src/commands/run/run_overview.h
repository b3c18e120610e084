// The first screen of a run: what a reader asks first, on 24 lines of 80 columns at most.
#pragma once

#include "commands/run/run_report.h"

enum { RUN_OVERVIEW_LINES = 24 };

// Of the run that is taken for the truth, or the last that is complete: of each joint with play its
// largest force, of each body its largest angular acceleration, of the drive its largest torque,
// each beside that with ideal joints; how the motion settled and what the damping does to it; how
// far ODE is off; and what was assumed. `is_alone` without the tables of run_text.c below it.
void run_overview_write(const RunReport *report, bool is_alone, Text *text);

// The whole first screen: title and overview.
void run_overview_screen(const void *report, const Style *style, Text *text);

// The same numbers, unrounded, as an object "overview".
void run_overview_json(json_t *object, const RunReport *report);

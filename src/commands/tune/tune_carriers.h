// Where else a setting can go: C code, a loop of one's own, Gazebo, MuJoCo.
#pragma once

#include "base/text.h"
#include "commands/tune/tune_report.h"
#include "write/style.h"

// The setting to hand on: the cheapest that meets the error, or what comes nearest to it; NULL
// where no run has an error.
const TuneTrial *tune_carriers_trial(const TuneReport *report);

// The setting for a loop that steps plainly with ERP and CFM alone: the cheapest that meets the
// error, or the best at the step that is held; NULL where there is none.
const TuneTrial *tune_carriers_plain(const Tune *tune);

// Appends the C program of that setting. Fails with ERR_CASE where a law does not fit its joint.
bool tune_carriers_code(const TuneReport *report, Text *text, Err *err);

// For people, one section each.
void tune_carriers_write(const TuneReport *report, const Style *style, Text *text);

// One setting of a search, for people.
#pragma once

#include "base/text.h"
#include "commands/tune/tune_report.h"

// What a setting takes of the processor, s: a median where it was timed, else the one run that
// found its error.
double tune_answer_time(const Tune *tune, const TuneTrial *trial);

// Appends the setting of a trial: its words, error and cost, its keys of a case, and its command
// line.
void tune_answer_setting(const TuneReport *report, const TuneTrial *trial, Text *text);

// A setting in words: its keys of a case, and the command line that runs it.
#pragma once

#include "base/text.h"
#include "commands/tune/tune_report.h"

// Whether a setting replaces what a --set KEY=VALUE gives for its key.
bool tune_setting_replaces(const char *override);

// Appends what a case says for the setting of a trial, each KEY=VALUE by itself, and a separator in
// between.
void tune_setting_keys(const TuneReport *report, const TuneTrial *trial, const char *separator,
                       Text *text);

enum { TUNE_SEPARATOR_SIZE = 64 };

// Appends the command line that runs the setting of a trial and reports its error, as a shell takes
// it; a separator, a blank at least, stands in front of each option.
void tune_setting_command(const TuneReport *report, const TuneTrial *trial, const char *separator,
                          Text *text);

// The scheme and its step or tolerance, for people.
void tune_setting_words(const TuneReport *report, const TuneTrial *trial, Text *text);

// What a setting takes of the processor, s: a median where it was timed, else the one run that
// found its error.
double tune_setting_time(const Tune *tune, const TuneTrial *trial);

// Appends the setting of a trial: its words, error and cost, its keys of a case, and its command
// line.
void tune_setting_write(const TuneReport *report, const TuneTrial *trial, Text *text);

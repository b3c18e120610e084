// What can be had at a step that is held, for people.
#pragma once

#include "base/text.h"
#include "commands/tune/tune_report.h"
#include "write/style.h"

// Appends the best setting at the step, whether it meets the error, the longest step that does
// where it does not, and every scheme at the step.
void tune_held_text_answer(const TuneReport *report, const Style *style, Text *text);

// Appends the constants that were run in the whole mechanism, each with its error.
void tune_held_text_constants(const Tune *tune, const Style *style, Text *text);

// Appends what one ERP and one CFM for all depths come to.
void tune_held_text_row(const Tune *tune, Text *text);

// Fails with ERR_DIFFERS: nothing at the step meets the error, how near it comes, and the longest
// step that does.
bool tune_held_text_unmet(const TuneReport *report, Err *err);

// Where constants come from, such as "law at 1.2 um".
void tune_held_text_source(const TuneLinear *linear, Text *text);

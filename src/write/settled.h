// How the start of a scenario was found, for people and programs: nothing of one that starts as it
// is written.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

#include <jansson.h>

// 1: the share of the revolutions of a motion that does not repeat that its headlines are above,
// and how sure all intervals are.
static const double SETTLED_QUANTILE = 0.95;

// Lines for the head of a result: what the motion does, after how many revolutions, and of each
// joint with play its largest force there beside that of the first revolution, which is not
// counted.
void settled_text(const Scenario *scenario, Text *text);

// The same on the first screen, in lines of 80 columns at most: of the joints whose forces are the
// largest.
void settled_lines(const Scenario *scenario, Text *text);

// The same, each sentence on one line that is not folded: for a page or below a table that has the
// forces.
void settled_sentences(const Scenario *scenario, bool is_below_table, Text *text);

// A sentence, not folded, where starts come to another motion in which a joint has a larger force
// than in that of the case's results, which stand `where`: "below". Nothing where none does.
void settled_louder(const Scenario *scenario, const char *where, Text *text);

// The same as an object "settled", in SI units.
void settled_json(json_t *object, const Scenario *scenario);

// One of its numbers: of `force_max` and N `force_max_N`, its interval `force_max_low_N` and
// `force_max_high_N`; likewise `force_median_N`, and `force_largest_N`. The stem is `force`.
void settled_json_number(json_t *object, const char *stem, const char *unit,
                         const SettledNumber *number);

// How the start of a scenario was found, for people and programs: nothing of one that starts as it
// is written.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

#include <jansson.h>

// Lines for the head of a result: what the motion does, after how many revolutions, and of each
// joint with play its largest force there beside that of the first revolution, which is not
// counted.
void settled_text(const Scenario *scenario, Text *text);

// The same on the first screen, in four lines of 80 columns at most: of the joints whose forces are
// the largest.
void settled_lines(const Scenario *scenario, Text *text);

// The same, each sentence on one line that is not folded: for a page.
void settled_sentences(const Scenario *scenario, Text *text);

// The same as an object "settled", in SI units.
void settled_json(json_t *object, const Scenario *scenario);

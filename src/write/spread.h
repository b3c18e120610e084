// What the inputs and the assumptions of a case add to its forces, for people and programs: nothing
// of one that nobody looked at.
#pragma once

#include "base/text.h"
#include "run/spread.h"

#include <jansson.h>

// Sentences for the first screen, each on one line that is not folded: the ranges of the loudest
// joint, what was assumed and what moves it most, and where a touch begins nearby.
void spread_sentences(const Spread *spread, Text *text);

// The same of all joints with play, as an object "spread", in SI units but for the inputs, which
// are in their own.
void spread_json(json_t *object, const Spread *spread);

// The probability that the range of so many independent draws holds 90 % of the distribution.
double spread_confidence(size_t draws);

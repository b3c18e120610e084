// What a scenario takes for granted because its case does not say it.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

#include <jansson.h>

// The assumptions on material, contact and start that runs make use of, in one sentence without its
// end: "law hertz-socket, restitution 0.9"; nothing where the case names all. A settled start is
// left to the sentence of the settled motion.
void assumed_text(const Scenario *scenario, Text *text);

// The same as an object "assumed", by key of a case, with the values in words.
void assumed_json(json_t *object, const Scenario *scenario);

// The friction of ideal joints in programs against libjointplay.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

#include <jointplay/jointplay.h>

// Fills in the library's friction of a joint; false where it has none, or a drive turns it, by
// which nothing moves.
bool tune_rubs_find(const Scenario *scenario, int joint, JpFriction *friction);

// Appends what makes it, of all joints that have it.
void tune_rubs_write(const Scenario *scenario, Text *text);

// What the library has no words for; NULL: nothing.
const char *tune_rubs_lack(const Scenario *scenario);

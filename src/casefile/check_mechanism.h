// What is wrong with a mechanism as a whole before it is solved: bodies that nothing holds, play
// that is larger than the links.
#pragma once

#include "casefile/entries.h"

// Every body has a joint, and no pin has room to reach another joint. To be called when all values
// are stored and before joints have anchors of their own. Fails with ERR_CASE or ERR_USAGE.
bool check_mechanism(const Entries *entries, const Scenario *scenario, Err *err);

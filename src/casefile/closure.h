// Whether the bodies and links of a case make a mechanism that closes, at the start and through the
// whole run.
#pragma once

#include "casefile/entries.h"

// Every body has a joint, and no pin has room to reach another joint. To be called when all values
// are stored and before joints have anchors of their own. Fails with ERR_CASE or ERR_USAGE.
bool closure_check_members(const Entries *entries, const Scenario *scenario, Err *err);

// Fails with the distances and what would close, or with the dead centre that stops the crank.
bool closure_check(const Entries *entries, const Scenario *scenario, Err *err);

// Checks of any other linkage that the loops of its ideal joints, where the drive determines them,
// let the crank turn through the run. A loop that a joint with play is part of is left to the run:
// play takes the crank a little further. Fails like closure_check.
bool closure_check_ideal(const Entries *entries, const Scenario *scenario, Err *err);

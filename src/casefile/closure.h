// Whether the links of a case's four-bar meet, at the start and through the whole run.
#pragma once

#include "casefile/entries.h"

// Fails with the distances and what would close, or with the dead centre that stops the crank.
bool closure_check(const Entries *entries, const Scenario *scenario, Err *err);

// Checks of any other linkage that the loops of its ideal joints, where the drive determines them,
// let the crank turn through the run. A loop that a joint with play is part of is left to the run:
// play takes the crank a little further. Fails like closure_check.
bool closure_check_ideal(const Entries *entries, const Scenario *scenario, Err *err);

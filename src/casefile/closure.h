// Whether the links of a case's four-bar meet, at the start and through the whole run.
#pragma once

#include "casefile/entries.h"

// Fails with the distances and what would close, or with the dead centre that stops the crank.
bool closure_check(const Entries *entries, const Scenario *scenario, Err *err);

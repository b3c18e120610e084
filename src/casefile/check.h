// What no single value of a case can show: keys that are missing, and values that do not fit
// together. Every error points at a place in the case.
#pragma once

#include "casefile/entries.h"

// Every required key is there.
bool check_required(const Entries *entries, Err *err);

// Pins fit their holes, contact and material options fit together, the run is of a sane size.
// To be called when all values are stored.
bool check_values(const Entries *entries, const Scenario *scenario, Err *err);

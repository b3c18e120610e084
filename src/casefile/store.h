// Values of a case into a scenario, in SI.
#pragma once

#include "casefile/entries.h"

// Understands the value of one entry and puts it into the scenario. A wrong value is an error with
// its place and what would be allowed.
bool store_value(const Entries *entries, const Entry *entry, Scenario *scenario, Err *err);

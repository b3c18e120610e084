// `expect:` of a case: limits for the numbers of its own runs.
#pragma once

#include "casefile/entries.h"
#include "casefile/expect_limit.h"

// What a number is to a limit; of a joint whose limits turn it forces are torques.
ExpectRow expect_row(NumberId id, NumberTurn turn);

// Reads the mapping of an entry into the scenario, whose bodies and joints have their names. Fails
// on a path that names no number of this case, and on a limit that cannot be understood.
bool expect_store(const Entries *entries, const Entry *entry, Scenario *scenario, Err *err);

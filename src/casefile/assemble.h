// From the keys that a case gives to its scenario.
#pragma once

#include "casefile/entries.h"

// Understands and checks all values and builds the scenario, start motions included; its path is
// the name of the case's source. Every error points at its place; the scenario is then untouched.
bool assemble_scenario(const Entries *entries, Scenario *scenario, Err *err);

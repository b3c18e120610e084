// A word about settings of the command line that change nothing.
#pragma once

#include "model/scenario.h"

// Says in one line on standard error which of the overrides (KEY=VALUE, each a key with a value of
// its own) the scenario makes no use of; nothing where it makes use of all.
void idle_settings_say(const Scenario *scenario, const char *const *overrides, size_t count);

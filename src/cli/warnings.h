// Warnings before a case runs.
#pragma once

#include "cli/common_options.h"

// Says, unless quiet, what in the case is unlikely to be meant, and which settings of --set nothing
// in it makes use of.
void warnings_say(const Scenario *scenario, const CommonOptions *options);

// Warnings before a case runs.
#pragma once

#include "cli/common_options.h"

// Says, unless quiet, what in the case is unlikely to be meant, and which keys of the case and of
// the command line nothing in it makes use of.
void warnings_say(const Scenario *scenario, const CommonOptions *options);

// Settles the runs of a study that follow one another (spec.h).
#pragma once

#include "commands/study/design.h"

// Gives the scenario of a run its settled start: where the study follows a key from that of the run
// before it along the key, and so from the first value on; else its own, as settle_scenario. What
// comes out depends on the study and the run's number alone, whatever else the process has made.
void follow_settle(const Spec *spec, uint64_t run, Scenario *scenario);

// Settles the runs of a study from the settled motions of their neighbours.
//
// Looking for a motion from many starts takes far longer than a run that begins near it. Twenty
// groups of runs in a row are therefore a block: two of its groups find their motion by themselves,
// a quarter and three quarters along; from the first of them each further group starts in the
// motion of the group before it, on to the second, which so has its motion twice. Where these are
// one motion, the rest of the block is settled in the same way; where they are not, or one of the
// two has several, each group of the block finds its own.
//
// A motion that does not repeat has numbers that many revolutions have to tell. Where the two have
// them, each group finds its own; where run.settle-budget is too short for that, a neighbour's
// motion is as good a start as any, and the numbers are left to the two.
#pragma once

#include "commands/study/design.h"

// Gives the scenario of a run its settled start. What comes out depends on the study and the run's
// number alone (but for a budget of time that is spent). The first run of a block in a process
// settles the block; its limit of so many seconds, 0 for none, begins anew with each of its groups.
void neighbours_settle(const Spec *spec, uint64_t run, double limit_s, Scenario *scenario);

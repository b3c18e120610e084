// What the files that settle a mechanism share.
#pragma once

#include "base/side_by_side.h"
#include "run/settle.h"

// What some starts have come to, as one motion: what counts of the revolutions of all of them, or,
// where it repeats, the last period of the first. Shares are of so many starts.
SettledMotion settle_motion_of(const Settling *const *settlings, size_t count, size_t of);

// 1: of a motion that does not repeat the widest half interval of a joint's headline, over the
// headline; INFINITY where too few revolutions bound one.
double settle_motion_width(const SettledMotion *motion, const Linkage *linkage);

// Whether two starts that do not repeat have clearly different distributions of largest forces.
bool settle_motions_differ(const SettledMotion *a, const SettledMotion *b, const Linkage *linkage);

// Looks for the settled motions of a scenario from so many starts, the first of which is that of
// `first`, a scenario of the same linkage, and puts what they have come to into the scenario. False
// where no start came to anything: the scenario then says why.
bool settle_search(Scenario *scenario, const Scenario *first, size_t count, RunWatch watch);

// Positions, velocities and all that counts of the start of one linkage become that of another.
void settle_take_start(const Linkage *from, Linkage *to);

// The runs of a period from starts beside the settled one, in pieces, where few of them tell all;
// the watch, which outlives them, has their revolutions.
typedef struct MonodromyRuns MonodromyRuns;
MonodromyRuns *monodromy_runs_begin(const Scenario *scenario, TurnWatch *watch);
SideBySideTasks monodromy_runs_tasks(MonodromyRuns *runs);

// Whether the growth could be told from them.
bool monodromy_runs_end(MonodromyRuns *runs, Scenario *scenario);

// The runs from starts beside the settled one until their changes are gone, likewise.
typedef struct BesideRuns BesideRuns;
BesideRuns *beside_runs_begin(const Scenario *scenario, TurnWatch *watch);
SideBySideTasks beside_runs_tasks(BesideRuns *runs);
void beside_runs_end(BesideRuns *runs, Scenario *scenario);

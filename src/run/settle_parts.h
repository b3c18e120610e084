// What the files that settle a mechanism share.
#pragma once

#include "base/side_by_side.h"
#include "run/settle.h"

// What one has come to, as a motion of one start.
SettledMotion settling_motion(const Settling *settling);

// The runs with other damping, in pieces. NULL where nothing is settled or damped; the watch, which
// outlives them, then has their revolutions.
typedef struct DampingRuns DampingRuns;
DampingRuns *damping_runs_begin(const Scenario *scenario, TurnWatch *watch);
SideBySideTasks damping_runs_tasks(DampingRuns *runs);

// Puts what they have come to into the scenario, and frees them.
void damping_runs_end(DampingRuns *runs, Scenario *scenario);

// The runs from starts beside the settled one, likewise.
typedef struct BesideRuns BesideRuns;
BesideRuns *beside_runs_begin(const Scenario *scenario, TurnWatch *watch);
SideBySideTasks beside_runs_tasks(BesideRuns *runs);
void beside_runs_end(BesideRuns *runs, Scenario *scenario);

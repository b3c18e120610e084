// What the files that settle a mechanism share.
#pragma once

#include "base/side_by_side.h"
#include "run/settle.h"

#include <stdatomic.h>

// 1: sections and forces of one motion, from two starts, differ by less: a peak's five digits
extern const double SETTLE_SAME_MOTION;

// How far all revolutions of a search have come, by several threads.
typedef struct TurnWatch {
    RunWatch watch;
    double started_s;     // by the clock
    atomic_size_t turned; // revolutions so far
    size_t most;          // that there may be
} TurnWatch;

TurnWatch turn_watch_begin(RunWatch watch);

// One more; the listener is told in the caller's thread alone.
void turn_watch_count(TurnWatch *watch, bool is_callers);

// The number of the last revolutions that count: of a motion that does not repeat the later half.
size_t settling_counted(const Settling *settling);

// The largest forces of a joint in them, N; returns how many.
size_t settling_forces(const Settling *settling, size_t joint, double *forces);

// How far the last so many revolutions of two are apart, relative, from whichever of the second's
// they are nearest; the second has as many.
double settling_apart(const Settling *a, const Settling *b, size_t period);

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

// The settled motion of a mechanism: what is left of its start once it has turned long enough.
//
// A drive of constant speed maps the state at one crank angle to that a revolution later, and one
// whose speed repeats to that a period later, which counts as a revolution here. Where one of them,
// or some, bring a state back, the motion repeats; else it goes on for ever without.
#pragma once

#include "run/settling.h"

// What is watched while it is looked for, in words.
#define SETTLE_DOING "settling, of run.settle-budget"

// Whether anything in it loses energy: without, there is no motion that is left of a start.
bool settle_dissipates(const Scenario *scenario);

// Gives a scenario that is to start settled or pressed that start, and says how it was found; one
// that has it, or starts as written, stays as it is. The settled motion is looked for from
// run.settle-starts starts side by side, within run.settle-budget. Where there is none the scenario
// says why. The watch is told of all revolutions as a share of run.settle-least of each start.
void settle_scenario(Scenario *scenario, RunWatch watch);

// The same from the settled start of a neighbour alone: the scenario of another value of one key,
// in the plane, without limits of its coordinates. Returns false where that cannot be made a start
// of this one; it is then settled as above.
bool settle_follow(Scenario *scenario, const Scenario *neighbour, RunWatch watch);

// The same for a study. A neighbour whose motion does not repeat, and of which too few revolutions
// are known to bound its largest forces, lends a start and no more: from there it is turned for two
// revolutions, so that it begins to do what it does (settled.is_brief). False, and nothing is
// settled, where it does not repeat and these are known, or where there is no such start.
bool settle_beside_neighbour(Scenario *scenario, const Scenario *neighbour, RunWatch watch);

// Whether it is clear which motion a neighbour is to come to: it was found, and is the only one or,
// of several, one that does not repeat, which a start near it falls into.
bool settle_is_clear(const Scenario *scenario);

// Whether two settled scenarios of one mechanism have clearly come to one motion: both repeat, to
// forces that differ by 1e-3 at most, or neither does, and their forces are not distributed in
// clearly different ways. The largest relative difference of a joint's largest force, 1; NAN where
// none is known.
bool settle_is_same(const Scenario *a, const Scenario *b, double *apart);

// Gives a scenario that differs from another in its numbers alone the start of that one's settled
// motion: pins as far on their way to the wall, or as deep in it, speeds in proportion to the
// drive's, and what has been counted since the start as written. `written` is the other linkage
// there, `settled` in its motion. False, the scenario untouched, where it has no such start.
bool settle_lend(const Linkage *written, const Linkage *settled, Scenario *scenario);

// Gives a scenario the settled start of another that differs from it in how it is run alone.
void settle_take(Scenario *scenario, const Scenario *settled);

// Finds by what factor a small change of the state grows in a revolution of the settled motion of a
// scenario: nothing of one that has none.
void settle_growth(Scenario *scenario, RunWatch watch);

// Gives the bodies of a scenario other velocities, by that of the drive at their reach times a
// size; the member is the seed. False where joints and drive leave no freedom.
bool settle_change_start(Scenario *scenario, double size, unsigned member);

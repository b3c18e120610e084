// The settled motion of a mechanism: what is left of its start once it has turned long enough.
//
// A drive of constant speed maps the state at one crank angle to that a revolution later, and one
// whose speed repeats to that a period later, which counts as a revolution here. Where one of them,
// or some, bring a state back, the motion repeats; else it goes on for ever without.
#pragma once

#include "model/state.h"
#include "run/run.h"

enum {
    SETTLE_PERIOD_MAX = 12, // revolutions after which a motion is seen to repeat, at most
    SETTLE_RATES = 6        // of a body at a section
};

// What happened in one revolution.
typedef struct Revolution {
    double *force_max; // N, by joint, of those with play; owned
    size_t *impacts;   // by joint: contacts begun; owned
    double *section;   // velocities at its end, SETTLE_RATES of each body; owned
    bool is_loose;     // it was turned at a looser tolerance than that of the result
} Revolution;

typedef struct Settling {
    Scenario scenario;       // whose start is that of the next revolution; owned
    double fastest;          // m/s, of any point of a body at the sections so far
    size_t count;            // revolutions so far
    Revolution *revolutions; // owned
    RunState state;          // at the end of the last
    size_t evaluations;
    bool is_random; // it does not repeat, and what it does in a revolution no longer drifts
    size_t period;  // revolutions after which it repeats; 0: it has not yet
    double change;  // 1: over the last period, of sections and largest forces
    double left;    // 1: what is estimated to be still to come of it
    // That another start has come to and that repeats: once it has come to the same its period is
    // found. NULL: none is known.
    const struct Settling *known;
    bool is_quick; // its first revolutions are not shown, and as loose as its motion allows
    struct TurnWatch *watch; // told of each revolution; NULL: nobody wants to know
    bool is_callers;         // it is turned in the thread of who asked for it
} Settling;

// Prepares a scenario whose drive has a period; it starts as the scenario does.
Settling settling_start(const Scenario *scenario);
void settling_finish(Settling *settling);

// Gives the bodies of a scenario other velocities, by that of the drive at their reach times a
// size; the member is the seed. False where joints and drive leave no freedom.
bool settle_change_start(Scenario *scenario, double size, unsigned member);

// Goes on by one revolution. Fails with ERR_SOLVER.
bool settling_turn(Settling *settling, Err *err);

// Gives a scenario that is to start settled or pressed that start, and says how it was found; one
// that has it, or starts as written, stays as it is. The settled motion is looked for from
// run.settle-starts starts side by side. Where there is none the scenario says why. The watch is
// told of all revolutions as a share of run.settle-most of each start.
void settle_scenario(Scenario *scenario, RunWatch watch);

// The same from the settled start of a neighbour alone: the scenario of another value of one key,
// in the plane, without limits of its coordinates. Returns false where that cannot be made a start
// of this one; it is then settled as above.
bool settle_follow(Scenario *scenario, const Scenario *neighbour, RunWatch watch);

// What lies beside the settled motion of a scenario: nothing of one that has none.

// Finds how the largest forces move when its damping is halved and doubled, to the four digits that
// are shown of them. A motion that does not repeat within 32 revolutions has the median of half of
// them.
void settle_damping(Scenario *scenario, RunWatch watch);

// Finds by what factor a small change of the state grows in a revolution.
void settle_growth(Scenario *scenario, RunWatch watch);

// Finds both at the same time, with the same numbers.
void settle_beside(Scenario *scenario, RunWatch watch);

// Goes on until the motion repeats to within a tolerance, relative, until what it does in a
// revolution no longer drifts though nothing repeats, or so many revolutions are over. Fails with
// ERR_SOLVER.
bool settling_run(Settling *settling, double tolerance, size_t most, Err *err);

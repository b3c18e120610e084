// One start of a mechanism on its way to the motion that is left of it, revolution by revolution.
#pragma once

#include "model/state.h"
#include "run/turn_watch.h"

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
    bool is_quick;    // its first revolutions are not shown, and as loose as its motion allows
    TurnWatch *watch; // told of each revolution; NULL: nobody wants to know
    bool is_callers;  // it is turned in the thread of who asked for it
} Settling;

// Prepares a scenario whose drive has a period; it starts as the scenario does.
Settling settling_start(const Scenario *scenario);
void settling_finish(Settling *settling);

// Goes on by one revolution. Fails with ERR_SOLVER.
bool settling_turn(Settling *settling, Err *err);

// Goes on until the motion repeats to within a tolerance, relative, until what it does in a
// revolution no longer drifts though nothing repeats, or so many revolutions are over. Fails with
// ERR_SOLVER.
bool settling_run(Settling *settling, double tolerance, size_t most, Err *err);

// 1: sections and forces of one motion, from two starts, differ by less: a peak's five digits
extern const double SETTLE_SAME_MOTION;

// The number of the last revolutions that count: of a motion that does not repeat the later half.
size_t settling_counted(const Settling *settling);

// The largest forces of a joint in them, N; returns how many.
size_t settling_forces(const Settling *settling, size_t joint, double *forces);

// How far the last so many revolutions of two are apart, relative, from whichever of the second's
// they are nearest; the second has as many.
double settling_apart(const Settling *a, const Settling *b, size_t period);

// How far can the drive turn a linkage before its loops can no longer be closed?
#pragma once

#include "model/scenario.h"

typedef enum LockState {
    LOCK_UNKNOWN, // the drive alone does not say where the bodies are, or nothing says it anywhere
    LOCK_NONE,    // the drive turns through the whole range
    LOCK_FOUND,   // it does not: at an angle within it the linkage locks
} LockState;

typedef struct Lock {
    LockState state;
    double crank_angle; // rad, of the driven body where it locks, or up to where it does not
    bool has_crossing;  // whether it passes a change point before that
    double crossing;    // rad, its angle at the first one
} Lock;

// Which joints keep bodies together.
typedef enum LockJoints {
    LOCK_ALL_AS_IDEAL, // all, as if none had play
    LOCK_IDEAL_ONLY,   // those without play; the others are left open
} LockJoints;

// Turns the driver from its start through an angle, rad, and looks whether that part of the linkage
// that it determines can follow. Change points, where two ways to go on cross, are passed and
// noted, unless redundant joints hide them. The angle of a lock is right to 1e-8 rad or better,
// that of a change point to 1e-5 rad. Takes some milliseconds.
Lock lock_find(const Linkage *linkage, LockJoints joints, double turn);

// The same as far as the driver turns to either side; what lies on its way back first.
Lock lock_find_between(const Linkage *linkage, LockJoints joints, DriveExtent extent);

// The lock that a run which failed at a time, s, had reached or nearly reached by then. A run that
// locks presses its pins into their walls some degrees before or, with play, beyond that angle.
Lock lock_met(const Scenario *scenario, double time_s);

// Adds the cause to the error of a run that failed at a time, s, where that is such a lock.
void lock_explain(const Scenario *scenario, double time_s, Err *err);

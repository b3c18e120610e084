// Tolerance stack-up: how far can link tolerances and joint play move a four-bar's extremes?
//
// Every length may stand anywhere in its tolerance. Play counts as a massless link of the radial
// clearance that lies along one of the two links the joint joins, stretching or shortening it:
// the motion while pin and hole stay pressed together in one direction of that link. Impacts are
// not part of it; they are what the other solvers are for.
#pragma once

#include "analytic/fourbar_motion.h"
#include "model/scenario.h"

enum {
    STACKUP_LENGTHS = 4, // ground, crank, coupler, follower
    STACKUP_PLAYS = 3,   // crank-coupler, coupler-follower, follower-ground
    STACKUP_SOURCES = STACKUP_LENGTHS + STACKUP_PLAYS,
};

// One combination: the lengths as they stand, and which link each play stretched or shortened.
typedef struct StackupCombination {
    int length_side[STACKUP_LENGTHS]; // -1 smallest, 0 nominal, +1 largest
    int play_link[STACKUP_PLAYS];     // number of the length the play adds to, or -1
    int play_sign[STACKUP_PLAYS];     // +1 stretched, -1 shortened, 0 no play
} StackupCombination;

typedef struct StackupBound {
    double value;                   // rad/s, rad/s^2 or rad
    StackupCombination combination; // that gives it
    double alone[STACKUP_SOURCES];  // change of the nominal value by each source of it alone
} StackupBound;

typedef struct StackupRow {
    double nominal_low; // of the ideal mechanism over a turn
    double nominal_high;
    StackupBound low;  // the smallest the low can become
    StackupBound high; // the largest the high can become
} StackupRow;

typedef struct Stackup {
    bool has_sources; // whether there is any tolerance or play at all
    bool is_source[STACKUP_SOURCES];
    double play[STACKUP_PLAYS]; // m, radial clearance; 0 for an ideal joint
    StackupRow rows[FOURBAR_QUANTITY_COUNT];
} Stackup;

extern const char *const STACKUP_LENGTH_NAMES[STACKUP_LENGTHS];
extern const char *const STACKUP_SOURCE_NAMES[STACKUP_SOURCES];
extern const char *const STACKUP_QUANTITY_NAMES[FOURBAR_QUANTITY_COUNT];

// Lengths of one combination.
FourBarLengths stackup_lengths(const FourBar *fourbar, const double play[STACKUP_PLAYS],
                               const StackupCombination *combination);

// Tries every corner of the tolerances with every placing of the play. Fails with ERR_SOLVER where
// the scenario is no four-bar, or where in some corner the crank no longer turns fully.
bool stackup_compute(const Scenario *scenario, Stackup *stackup, Err *err);

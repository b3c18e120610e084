// The dimensions of a four-bar as a case file's short form gives them, and what they make possible.
//
// The crank turns about the origin, the follower about (ground, 0); the coupler joins their ends.
#pragma once

#include "base/err.h"

#include <stdbool.h>

// One length with its tolerance: any value in [nominal + lower, nominal + upper].
typedef struct ToleratedLength {
    double nominal; // m
    double lower;   // m, zero or negative
    double upper;   // m, zero or positive
} ToleratedLength;

typedef enum Assembly {
    ASSEMBLY_OPEN, // the follower end lies to the left of the line from crank pin to ground pivot
    ASSEMBLY_CROSSED, // to the right of it
} Assembly;

typedef struct FourBar {
    ToleratedLength ground;
    ToleratedLength crank;
    ToleratedLength coupler;
    ToleratedLength follower;
    Assembly assembly;
} FourBar;

typedef enum GrashofClass {
    GRASHOF_CRANK_ROCKER,  // the crank turns fully, the follower swings
    GRASHOF_DOUBLE_CRANK,  // crank and follower turn fully (drag link)
    GRASHOF_ROCKER_CRANK,  // the follower turns fully, the crank swings
    GRASHOF_DOUBLE_ROCKER, // the coupler turns fully, crank and follower swing
    GRASHOF_TRIPLE_ROCKER, // no link turns fully
    GRASHOF_CHANGE_POINT,  // the longest and shortest together equal the other two
} GrashofClass;

extern const char *const FOURBAR_GRASHOF_NAMES[]; // by GrashofClass

// The class of the nominal lengths (Grashof's rule; lengths equal to 1e-12 count as equal).
GrashofClass fourbar_grashof(const FourBar *fourbar);

// Whether the crank can turn through every angle.
bool fourbar_crank_turns(const FourBar *fourbar);

// The interval of the diagonal from crank pin to follower pivot, m, in which coupler and follower
// can meet: the loop closes at a crank angle when the diagonal lies in it, and is at a dead centre
// of the follower side when the diagonal equals one of its ends.
void fourbar_diagonal_range(const FourBar *fourbar, double *shortest, double *longest);

// Length of that diagonal at a crank angle, m.
double fourbar_diagonal(const FourBar *fourbar, double crank_angle);

// A constraint of Chipmunk's that holds the centre of a body on a line of another.
#pragma once

#include <chipmunk/chipmunk.h>

// The line goes through a point of body a along a direction, both in its frame; body b's centre of
// gravity stays at the same distance from it. The space that it is added to owns it.
cpConstraint *chipmunk_line_new(cpBody *a, cpBody *b, cpVect direction);

// And one that keeps how far that centre has gone along a direction since the start between two
// ends, m; either may be infinite.
cpConstraint *chipmunk_ends_new(cpBody *a, cpBody *b, cpVect direction, double low, double high);

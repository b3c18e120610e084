// The coordinate of a hinge or a slider of ODE, as its getters have it: the first body against the
// second.
#pragma once

#include "world/direction.h"

typedef struct Coordinate {
    dJointID joint;
    bool is_angle;
    dBodyID bodies[2]; // NULL is the world
    double start;      // rad or m, where it was made
    dVector3 axis;     // of a slider in the frame of the second body; of a hinge likewise
    dVector3 offset;   // m, of a slider: from the second body's centre to the first's, there
    dQuaternion turn;  // of a hinge: of the first body seen from the second, there
    double last;       // rad: the angle as read last, from which turns are counted on
} Coordinate;

// The coordinate of a joint that is a hinge or a slider with a body.
Coordinate coordinate_of(dJointID joint);

// Where it is, rad or m: an angle goes on beyond half a turn.
double coordinate_read(Coordinate *coordinate);

// The direction in which it grows, as the bodies stand.
Direction coordinate_direction(const Coordinate *coordinate);

// The coordinate of a hinge or a slider of ODE, as its getters have it: the first body against the
// second.
#pragma once

#include <ode/ode.h>

#include <stdbool.h>

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

// Its rate, rad/s or m/s.
double coordinate_rate(const Coordinate *coordinate);

// The axis in the world, and, of a slider, where a force along it acts on both bodies.
void coordinate_axis(const Coordinate *coordinate, dVector3 axis);
void coordinate_point(const Coordinate *coordinate, dVector3 point);

// Pushes the bodies apart along it, N m or N, in the next step.
void coordinate_push(const Coordinate *coordinate, double force);

// Its acceleration for a force of 1, with both bodies free: more than they have where joints hold
// them. 1/(kg m^2) or 1/kg.
double coordinate_mobility(const Coordinate *coordinate);

// A direction in which two bodies move or turn against each other, as it stands at one instant.
#pragma once

#include "world/bodies.h"

#include <ode/ode.h>

#include <stdbool.h>

// A force of 1 in it pushes the first body along the axis and the second the other way, each at a
// point of its own. Of a turn it is a torque about the axis.
typedef struct Direction {
    dBodyID bodies[2]; // NULL is the world
    bool is_turn;
    dVector3 axis;    // unit, in the world
    dVector3 arms[2]; // m, in the world, from the bodies' centres to the points; not of a turn
} Direction;

// Along an axis at a point of either body, and about an axis.
Direction direction_along(const dBodyID bodies[2], const dReal *axis, const dReal *first,
                          const dReal *second);
Direction direction_about(const dBodyID bodies[2], const dReal *axis);

// The same a time later, s: its arms have gone on with the bodies, its axis has not.
Direction direction_later(const Direction *direction, double time);

// Lets its arms go on with small moves of all bodies, six numbers each.
void direction_move(Direction *direction, const Bodies *bodies, const double *moves);

// How fast the first body goes in it against the second, with their present velocities.
double direction_rate(const Direction *direction);

// How far one of the bodies goes in it, as the first has it, by a way and a turn of small size.
double direction_of_move(const Direction *direction, int number, const double move[6]);

// Pushes the bodies with a force in the next step.
void direction_push(const Direction *direction, double force);

// The acceleration in it for a force of 1 with both bodies free: more than they have where joints
// hold them. 1/kg or 1/(kg m^2).
double direction_mobility(const Direction *direction);

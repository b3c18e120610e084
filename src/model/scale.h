// How fast will a scenario move, before it has moved? Sizes for errors and for rounding.
#pragma once

#include "base/carry.h"
#include "model/scenario.h"

typedef struct SpeedScale {
    double moving;   // m/s, of the fastest point of all bodies: above 0
    double changing; // m/s^2, of its velocity: above 0
    // rad/s and rad/s^2, by body: with which its furthest joint moves as that point does. Of a body
    // that hangs on a pivot far away these are small, as its own are.
    double *turning; // owned, like the next
    double *speeding;
    double *reaches; // m, by body: linkage_reach
} SpeedScale;

// The largest of the speeds at the start, of the driven body's, and of a fall under gravity as long
// as the largest body or one period of the drive; 1 m/s where nothing moves and nothing pulls. It
// depends on the bodies alone: not on the origin or the frames that the case is written in. For
// scale_free.
SpeedScale scale_speeds(const Scenario *scenario);

void scale_free(SpeedScale *scale);

// The least that anything of a run is measured in, so that what is at rest is not held against its
// own rounding.
typedef struct ScaleFloor {
    double speed;        // m/s, of a point; of an angular rate it is divided by the body's reach
    double acceleration; // m/s^2, likewise
    double force;        // N
    double torque;       // N m
    double energy;       // J
} ScaleFloor;

// A ten-millionth of how fast the scenario would move if it fell, was pushed or went on as it
// started, of its changes, and of the forces that these take; where pins may rest in their holes, a
// hundred-thousandth of the speed. Of a mechanism that is driven a ten-millionth of its drives'
// speed. Of the energy the square of a millionth, and the rounding of its potential energy, which
// depends on the origin.
ScaleFloor scale_floor(const Scenario *scenario);

// Carries the speeds seen so far, of a linkage.
void scale_carry(const Linkage *linkage, SpeedScale *scale, Carry *carry);

// Raises the scale to a speed of the fastest point, m/s, that was seen. Returns whether it is one
// above the scale.
bool scale_raise(const Linkage *linkage, double moving, SpeedScale *scale);

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

// Carries the speeds seen so far, of a linkage.
void scale_carry(const Linkage *linkage, SpeedScale *scale, Carry *carry);

// Raises the scale to a speed of the fastest point, m/s, that was seen. Returns whether it is one
// above the scale.
bool scale_raise(const Linkage *linkage, double moving, SpeedScale *scale);

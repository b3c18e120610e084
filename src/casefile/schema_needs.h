// What a key of a case may ask of the scenario before it matters.
#pragma once

#include "casefile/schema.h"

// A row asks for all of its bits.
enum {
    MEMBER = 1 << 0,        // the body, joint or point is there
    OWN_STIFFNESS = 1 << 1, // the joint has a stiffness of its own
    FREE = 1 << 2,          // no drive determines how the bodies move
    DRIVE = 1 << 3,         // there is a drive
    TIMED = 1 << 4,         // its speed is not constant, or there is none: seconds measure the run
    PLAY = 1 << 5,          // some joint has play
    IMPACT = 1 << 6,        // and the contact is of that model
    POISSON = 1 << 7,
    LAW = 1 << 8,       // its stiffness is that of a law
    STIFFNESS = 1 << 9, // or given
    MATERIAL = 1 << 10, // the law, or the paper's Eq. (9) for the penalty
    VISCOUS = 1 << 11,
    FRICTION = 1 << 12,
    REFERENCE = 1 << 13,
    ODE = 1 << 14,
    QUICK = 1 << 15,
    IDEAL = 1 << 16, // no joint has play
    GIVEN_STEP = 1 << 17,
    CHOSEN_STEP = 1 << 18,
    PLAIN = 1 << 19, // the stepping of a given step
    EXTRAPOLATED = 1 << 20,
    LOCAL = 1 << 21,               // the contact is integrated within the step
    VALUED = 1 << 22,              // the key has a value above 0
    FACETED = 1 << 23,             // the collider takes holes for polygons
    SPATIAL = 1 << 24,             // bodies move in space
    TORQUE = 1 << 25,              // a torque drives
    FORCE = 1 << 29,               // or a force
    DRIVEN = 1 << 26,              // there is a drive, a torque or a force
    OWN = 1 << 27,                 // the joint notes that it has the value of its own
    REPEATING = 1 << 30,           // all that acts has a period in common
    DISSIPATING = (int)(1U << 31), // the damping dissipates without a memory
    TURNING = 1 << 28,             // the drive's speed is constant: revolutions measure the run
};

// Likewise, of a key that stays a setting of a run without them: it is named as one without effect.
enum {
    COMMON_STIFFNESS = 1 << 0, // some joint with play has no stiffness of its own
    COMMON_DAMPING = 1 << 1,   // or no damping
    REBOUND = 1 << 2,          // a restitution of the contact sets the damping of some joint
    OWN_REBOUND = 1 << 3,      // or that of the joint sets its own
    PIN = 1 << 4,              // a pin has play in its hole
    HELD_ROWS = 1 << 5,        // ODE has rows of an ideal joint
    ANY_ROWS = 1 << 6,         // or any
    SMOOTHED = 1 << 7,         // some solver lets friction set in over a speed
    BRISTLED = 1 << 19,        // friction has bristles somewhere
    MOVED = 1 << 8,            // a drive determines the motion before time zero
    COMMON_FRICTION = 1 << 10, // some joint with play has no friction of its own
    SETTLED = 1 << 11,         // runs start in the settled motion
    REMEMBERED = 1 << 12,      // the damping divides by the speed of the impact
    DERIVED = 1 << 13,         // what is lost follows from a restitution
    UNSTEADY = 1 << 14,        // the drive's speed is not constant
    ELASTIC_PIN = 1 << 18,     // the joint's stiffness is that of the elastic law
    GROWING = 1 << 15,         // the damping grows with the depth
    LENGTHWISE = 1 << 17,      // the law of the joint has a length in it, or its space has
    COMMON_DEPTH = 1 << 16,    // some joint with play has no depth of its own for that
    SHUFFLED = 1 << 9,         // the quick solver comes to change the order of the rows
};

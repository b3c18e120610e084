// Where is a pin in space against one place at which its hole can stop it?
//
// A hole of width w stops a round pin at its two ends, and where the pin has collars, along the
// axis. At an end the pin's section is taken for a circle about the pin's axis: with O the centre
// of that end, on body a, and P the point of the pin's axis nearest to it,
//     e = P - O,   gap = c - |e|,   d' = e . (v_b(P) - v_a(O)) / |e|.
// The force is at right angles to the pin's axis, on the line through O and P. A pin tilted to its
// limit has sin(phi) = 2 c / w; the round edge itself adds R (1 - cos phi) to the play, which this
// leaves out. Along the axis, with M the pin's middle and u the hole's axis,
//     e = u . (M - middle of the hole),   gap = axial clearance - |e|,
//     d' = sign(e) u . (v_b(M) - v_a(M)):
// a collar touches the hole's face at the axis, without friction.
// No matter how the pin turns about its own axis, none of this changes.
#pragma once

#include "kernel/force_law.h"
#include "model/trajectory.h"

enum {
    PIN_SPACE_ENDS = 2,   // places 0 and 1, at -w/2 and +w/2 along the hole's axis
    PIN_SPACE_COLLAR = 2, // place 2
    PIN_SPACE_PLACES = 3, // at most, of one joint
};

// One place of a joint with play.
typedef struct PinSpace {
    int joint;
    int place;
    double clearance; // m, radial or axial
    ForceLaw law;     // of this place alone: each end has half of the joint's, a collar all of it
    SpaceEnd hole;    // body a, anchor at this place (of a collar at the middle of the hole)
    SpaceEnd pin;     // body b, anchor at the pin's middle
} PinSpace;

typedef struct PinSpacePose {
    Vec3 at_a; // m, the point of body a at which the force acts
    Vec3 at_b; // likewise of body b; both lie on the force's line
    Vec3 offset;
    double gap;            // m, negative inside the metal
    bool has_normal;       // false for a centred pin, which has no nearest wall
    Vec3 normal;           // unit: direction of the force on the pin
    double approach_speed; // m/s, rate of the penetration; without a normal the relative speed
} PinSpacePose;

// Writes the places of all joints with play, joint by joint, and how many there are. Returns them
// for the caller to free, or NULL with ERR_CASE where a law does not fit a joint.
PinSpace *pin_space_list(const Scenario *scenario, size_t *count, Err *err);

// The elastic energy, J, that a joint's places hold in a state; 0 in the velocity-level model.
double pin_space_stored(const Scenario *scenario, size_t joint, const SpaceJointState *state);

// The pose of a pin at a place.
PinSpacePose pin_space_pose(const PinSpace *place, const SpaceMotion *motions);

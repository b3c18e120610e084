// A joint with play: two sides on the coordinate of a hinge or a slider, with or without a rotor.
#pragma once

#include "world/bodies.h"
#include "world/coordinate.h"
#include "world/refusal.h"
#include "world/side.h"

enum { SIDE_COUNT = 2 }; // the low one first

// What turns or slides between the two sides: a number, not a body.
typedef struct Rotor {
    double inertia; // kg m^2 or kg; infinite where its motion is given
    double position;
    double speed;
    double drive; // N m or N, on it
} Rotor;

struct JpJoint {
    JpWorld *world;
    JpJoint *next;
    Coordinate coordinate;
    Rotor rotor; // of stops: at 0 for ever
    bool is_backlash;
    double rotor_inertia; // as it was given: what a rotor that is driven again has
    Side sides[SIDE_COUNT];
    dJointID motor;   // the row of an angle; NULL of a slider
    dJointID contact; // the row of a slider in the step under way
    dJointFeedback feedback;
    dVector3 row_axis; // in the world: a push of the row on the first body of ODE's joint
    double pushed;     // N: what was put on from outside beside the row
    double rate;       // of the coordinate less the rotor's, at the start of the step under way
};

struct JpWorld {
    dWorldID id;
    JpWorldOptions options;
    Bodies bodies;
    JpJoint *joints;
    dJointGroupID rows; // contacts of sliders, of the step under way
    JpWorldStats stats;
    size_t known_when_counted; // bodies, when it was last made sure that all are known
};

// The rate of the coordinate less the rotor's.
double play_rate(const JpJoint *joint);

// Where the coordinate is, less the rotor.
double play_position(JpJoint *joint);

// The acceleration of that for a force of 1 with all bodies free.
double play_mobility(const JpJoint *joint);

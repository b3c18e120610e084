// A joint with play: the places at which its bodies touch, on the coordinate of a hinge or slider
// with or without a rotor, or of a pin in its hole.
#pragma once

#include "contact/rub_row.h"
#include "world/bodies.h"
#include "world/coordinate.h"
#include "world/place.h"
#include "world/refusal.h"

// What turns or slides between the two sides: a number, not a body.
typedef struct Rotor {
    double inertia; // kg m^2 or kg; infinite where its motion is given
    double position;
    double speed;
    double drive; // N m or N, on it
} Rotor;

typedef enum PlayKind {
    PLAY_STOPS,
    PLAY_BACKLASH,
    PLAY_PIN,
    PLAY_FRICTION, // of a joint of ODE, without any place
} PlayKind;

enum {
    PIN_ENDS = 2,
    PLACES_MOST = PIN_ENDS + 1, // of a joint
};

// A pin in its hole. Places are the middle of the hole, or its two ends, and the collars.
typedef struct Pin {
    size_t hole_count;
    Vec3 holes[PIN_ENDS]; // m, in the frame of the hole's body: middle, or ends
    Vec3 middle;          // m, likewise, of the hole
    Vec3 pin;             // m, in the frame of the pin's body: its middle
    Vec3 axes[2];         // unit, in the frames of the pin's body and of the hole's
} Pin;

// What a step leaves behind of the friction of a hinge or slider (world/friction.h).
typedef struct RubFound {
    RubRow row;
    double force;     // N m or N, on the first body, mean of the last step
    double slid;      // J, lost
    bool is_sticking; // in the last step
} RubFound;

typedef struct Rub {
    RubFound found;
    Direction along;         // of the step under way
    dJointID motor;          // the row: of a hinge for ever, of a slider in a step; else NULL
    dJointFeedback feedback; // of that
    dJointFeedback reaction; // of ODE's joint, where the caller has none
} Rub;

// What a step found of a joint (world/found.h).
typedef struct JointFound {
    Rotor rotor;
    Vec3 force;
    double last; // rad, of the coordinate
    RubFound rub;
    struct {
        Side sides[SIDE_COUNT];
        KernelContact inside[SIDE_COUNT];
        double slid;
    } places[PLACES_MOST];
} JointFound;

struct JpJoint {
    JpWorld *world;
    JpJoint *next;
    size_t number; // among those of its world, in the order in which they were made, from 1
    PlayKind kind;
    dBodyID bodies[2];     // NULL is the world; of a pin in its hole the pin's first
    Coordinate coordinate; // not of a pin
    Pin pin;
    Rotor rotor;          // of stops and pins: at 0 for ever
    double rotor_inertia; // as it was given: what a rotor that is driven again has
    Vec3 force;           // N, of a pin: on the pin, mean of the last step
    size_t place_count;
    Place places[PLACES_MOST];
    Rub rub; // of friction
    // of a pin: joints of ODE without rows, from each of its bodies to the world, that lose their
    // body when it is destroyed
    dJointID watches[2];
    JointFound found;
};

// Steps without the cache, after one in which it was wrong (world/response_cache.h).
typedef struct CachePause {
    size_t steps; // of the last pause; 0 after one in which it was right
    size_t until; // number of the step
} CachePause;

// How long the next local steps of a world's contacts are to be (kernel/kernel.h), of a world that
// is resumed (world/saved.c) until its kernel is made.
typedef struct WorldPace {
    bool is_set;
    double longest_s[2];
    double duration_before_s;
    double stiff_width_s;
} WorldPace;

// What a step found of a world (world/found.h).
typedef struct WorldFound {
    bool is_kept;     // whether the last step can be taken back
    double last_step; // s, of the step before it
    size_t flown;     // likewise
    dVector3 gravity; // m/s^2
    double erp;
    JpWorldStats stats;
    CachePause pause;
} WorldFound;

struct JpWorld {
    dWorldID id;
    JpWorldOptions options;
    Bodies bodies;
    JpJoint *joints;
    dJointGroupID rows;     // contacts of the step under way
    dJointGroupID contacts; // of the geoms of the caller's space, likewise
    Kernel *kernel;         // owned, NULL before the first
    WorldPace pace;
    CachePause pause;
    struct ResponseCache *cache; // owned, NULL before the first (world/response_cache.h)
    JpWorldStats stats;
    double last_step;          // s, of the step before; 0: there was none
    size_t flown;              // steps with closed joints since contacts (world/impulse.c)
    size_t known_when_counted; // bodies, when it was last made sure that all are known
    dThreadingImplementationID threading; // owned; NULL: the caller's
    double *settling;                     // owned, of a first step under way (world/opening.h)
    WorldFound found;
    JpError coarse;   // of the step under way: JP_OK, or the first reason for JP_COARSE
    double work;      // done in the step under way (world/work.h)
    double work_most; // in a step
};

// How messages call a joint, such as "joint 2 (stops)".
typedef struct PlayName {
    char text[48];
} PlayName;

PlayName play_name(const JpJoint *joint);

// The unit of its lengths: rad, or m.
const char *play_unit(const JpJoint *joint);

// Fails where a body of a joint was destroyed, or ODE's joint got other bodies.
JpStatus play_check_bodies(const JpJoint *joint, JpError *error);

// Fails where a joint of ODE is no hinge or slider of a body of a world.
JpStatus play_check_joint(const JpWorld *world, dJointID joint, JpError *error);

// Whether all numbers of a joint are finite that steps change, and all of a side that is read but
// its gap.
bool play_is_finite(const JpJoint *joint);
bool play_is_side_finite(const JpSide *side);

// Adds a joint to a world; NULL where there is no memory.
JpJoint *play_add(JpWorld *world, PlayKind kind, const dBodyID bodies[2]);

// kg, of the two bodies of a joint against each other; what is kinematic, or the world, is held. 0
// where both are.
double play_mass(const JpJoint *joint);

// The mobility of a place along its direction with all bodies free, its rotor's included.
double play_mobility(const JpJoint *joint, const Place *place);

// The rate of a place along its direction, as it was found, with the present velocities.
double play_rate(const JpJoint *joint, const Place *place);

// How a side is, to be read.
JpSide play_side(const Side *side, double position);

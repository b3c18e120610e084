// A place at which the two bodies of a joint with play can touch.
#pragma once

#include "base/vec3.h"
#include "kernel/kernel.h"
#include "world/direction.h"
#include "world/side.h"

typedef enum PlaceShape {
    PLACE_LINE, // a coordinate between two sides
    PLACE_HOLE, // the axis of a pin in a round hole, whose one side is the wall
} PlaceShape;

enum {
    SIDE_COUNT = 2,       // the low one first
    PLACE_ROWS_MOST = 9,  // with friction in space
    PLACE_ROWS_PLANE = 2, // of a hole without friction
    PLACE_ROWS_ROUND = 4, // with friction round the pin alone
};

// What a row of ODE's is made and read by.
typedef struct PlaceRow {
    dJointID motor;   // the row of an angle; else NULL
    dJointID contact; // the row of a way in the step under way
    dJointFeedback feedback;
    dVector3 axis; // in the world: a push of the row on the first body of ODE's joint
    double pushed; // N: what was put on from outside beside the row
} PlaceRow;

typedef struct Place {
    PlaceShape shape;
    double clearance;                 // m, of a hole
    double hole_radius;               // m, of a hole
    double friction;                  // 1, likewise: mu, against the sliding
    double friction_speed;            // m/s, of mu N tanh(v / v_s)
    BristlePair bristle;              // of friction that holds, in place of that
    double slid;                      // J, lost in that
    Side sides[SIDE_COUNT];           // the position of a hole's is the gap
    KernelContact inside[SIDE_COUNT]; // as steps with contacts inside them left it
    PlaceRow row;
    // of the step under way
    double position; // where the step evaluates forces: of a line, less the rotor's, or the gap
    double rate;     // of that, with the velocities of the step's start
    Direction along; // in which it grows
    Vec3 point;      // m, in the world: where the force of a way acts
    Vec3 offset;     // of a hole at the step's start, m: of the pin's axis from the hole's centre
    Vec3 velocity;   // m/s, of that
    Vec3 sliding;    // m/s, of the pin's point against the hole's there
    double line_before; // of a line at the step's start
    double rate_before;
    Direction slide[2];       // at the wall, of a hole with friction: round it, and along the axis
    double sliding_before[2]; // m/s, before a step with a row
    bool slides_along;        // whether friction acts along the axis, too
    // where contacts are integrated within the step, as kernel/kernel.h has them
    size_t row_count;
    Direction rows[PLACE_ROWS_MOST];
    double start[PLACE_ROWS_PLANE];     // where these are at the step's start, m or rad
    double start_rate[PLACE_ROWS_MOST]; // and how fast all go there
} Place;

// The sides that a place has.
size_t place_side_count(const Place *place);

// How far the bristle of a hole's friction is bent as a caller counts it, m: by the turning of the
// pin, while the kernel counts the sliding of the pin at the wall, which goes the other way.
static inline double place_bend(const Place *place)
{
    return place->sides[0].state.is_touching ? 0.0 - place->sides[0].state.bend : 0.0;
}

// How a step finds a side, that starts earlier than forces are evaluated by a time, s.
SideMotion place_motion(const Place *place, size_t side, double earlier, double step);

// Whether a place comes to touch within a time, s, by its first rows: from where they are at the
// step's start, at speeds, with accelerations.
bool place_is_near(const Place *place, const double *speed, const double *acceleration,
                   double duration);

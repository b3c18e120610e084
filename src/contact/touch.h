// The places at which the bodies of a joint with play touch in the plane: a pin in its hole at one,
// a block between its guides (or a sleeve round a rod) at its four corners, a stop at one, a joint
// whose coordinate is limited at its two ends: place 0 is the low one, place 1 the high one.
//
// At every place a circle on body b (of radius 0: a point) meets a line or a circle of body a.
// With d from the anchor on body a to that on body b, n the direction of the force on body b, and
// closing speed the rate of the penetration:
//     hole    gap = c - |d|,      n = -d / |d|       c radial clearance
//     disc    gap = |d| - c,      n =  d / |d|       c sum of the radii
//     line    gap = m . d - c,    n =  m             m the line's normal, c radius on body b
//     cam     gap = distance from the profile - c, n its normal there (base/cam.h)
//     slot    gap = c - |e|,      n = -e / |e|       c half its width less the pin's radius
// with e from the nearest point of the slot's middle line, which goes through anchor a at right
// angles to m, half its length to either side (kernel/pin_hole.h).
// The ends of a slider's coordinate are lines across it. Of an angle and of teeth the gap is that
// of the coordinate q itself (model/coordinate.h):
//     turn    gap = s q - c,      no n               a torque s N on body b, in the sense of q
//     teeth   base/mesh.h
//     rack    gap = s q - c,      n = s t            t the pitch line's direction
// s is 1 at the low end and c its value, -1 at the high end and c less its value. Lengths are
// angles at a turn, and forces torques.
#pragma once

#include "kernel/force_law.h"
#include "kernel/pin_hole.h"
#include "model/coordinate.h"
#include "model/response.h"
#include "model/scenario.h"

// What rows a place has in a response, in which its contact is integrated.
typedef enum TouchRows {
    TOUCH_ROWS_WORLD,      // x and y of anchor b less anchor a, in the world
    TOUCH_ROWS_AXES,       // the same across and along axes of body a
    TOUCH_ROWS_LINE,       // the gap, which has a normal always, and the sliding
    TOUCH_ROWS_COORDINATE, // the gap alone: nothing slides
} TouchRows;

// How what touches is shaped: a row each, its enumerator; what rows of a response it has; whether
// it presses by a torque, and its lengths are angles; and what it is. Where what is done differs
// from shape to shape, a switch over shapes has no default, so that a new one is met there.
// clang-format off
#define TOUCH_SHAPE_LIST(member, with) \
    member(with, TOUCH_HOLE,  WORLD,      false, "a circle of body b in one of body a") \
    member(with, TOUCH_DISC,  WORLD,      false, "a circle of body b beside one of body a") \
    member(with, TOUCH_LINE,  LINE,       false, "a circle or point of body b at a line of body a") \
    member(with, TOUCH_CAM,   LINE,       false, "a circle or flat of body b at a profile of body a") \
    member(with, TOUCH_SLOT,  AXES,       false, "a circle of body b in a slot of body a") \
    member(with, TOUCH_TURN,  COORDINATE, true,  "an end of a revolute joint's angle") \
    member(with, TOUCH_TEETH, COORDINATE, false, "a flank of a pair of gears") \
    member(with, TOUCH_RACK,  COORDINATE, false, "a flank of a rack on body a and a pinion")
// clang-format on
#define TOUCH_SHAPE(with, id, ...) id,
typedef enum TouchShape { TOUCH_SHAPE_LIST(TOUCH_SHAPE, _) } TouchShape;

enum { TOUCH_CORNERS = 4 };

typedef struct Touch {
    int joint; // number in the linkage
    int place; // 0, or number of the corner
    TouchShape shape;
    Vec2 anchor_a;      // in body a's frame, m: centre of hole or disc, a point of the line
    Vec2 anchor_b;      // in body b's frame, m: centre of the circle
    double direction;   // rad, in body a's frame: of a line's normal, away from the wall; across a
                        // slot; of a rack's pitch line
    double clearance;   // m, or rad at a turn: c above
    double sign;        // s above; 0 of other shapes
    double radius_a;    // m, of hole or disc; 0 of a line, infinite of a rack; half the width of a
                        // slot
    double radius_b;    // m; of a pinion of its pitch circle
    double half_length; // m, of a slot's middle line
    Cam cam;            // of a cam
    ForceLaw law;       // of this place alone
} Touch;

// How a place is at an instant.
typedef struct TouchPose {
    Vec2 offset;           // d, m
    Vec2 velocity;         // m/s: of anchor b less that of anchor a
    double gap;            // m (rad at a turn), negative inside the metal
    bool has_normal;       // false of a circle whose centre is that of the other
    Vec2 normal;           // unit: direction of the force on body b; zero at a turn and without
                           // a normal
    double approach_speed; // m/s, rate of the penetration; without a normal the relative speed
    Vec2 from_b;           // m, of a cam and of gears: from anchor b to where they touch
    Vec2 middle;           // m, of a slot: from anchor a to the nearest point of its middle line
} TouchPose;

static inline TouchRows touch_rows(const Touch *place)
{
#define TOUCH_ROWS(with, id, rows, ...) TOUCH_ROWS_##rows,
    static const unsigned char ROWS[] = {TOUCH_SHAPE_LIST(TOUCH_ROWS, _)};
    return (TouchRows)ROWS[place->shape];
}

// Whether the gap of a place is a coordinate by itself, whose rate is the first of the place's rows
// in the response: it has a normal always, and no curvature.
static inline bool touch_is_scalar(const Touch *place)
{
    return touch_rows(place) >= TOUCH_ROWS_LINE;
}

// Whether a place is an end of an angle or of teeth, where nothing slides.
static inline bool touch_is_end(const Touch *place)
{
    return touch_rows(place) >= TOUCH_ROWS_COORDINATE;
}

// Whether a place has several walls, of which one is met at a time, and rows in its own axes.
static inline bool touch_has_walls(const Touch *place)
{
    return touch_rows(place) == TOUCH_ROWS_AXES;
}

// Whether what presses is a torque, and lengths are angles.
static inline bool touch_is_torque(const Touch *place)
{
#define TOUCH_TORQUE(with, id, rows, is_torque, ...) is_torque,
    static const bool TORQUES[] = {TOUCH_SHAPE_LIST(TOUCH_TORQUE, _)};
    return TORQUES[place->shape];
}

// Makes a list of the places of all joints with play, joint by joint, with their laws, which free()
// gives back. Fails with ERR_CASE where a law does not fit a joint.
bool touch_list(const Scenario *scenario, Touch **places, size_t *count, Err *err);

// Writes the places of one joint without their laws; returns how many there are, 0 of an ideal one.
size_t touch_places(const Linkage *linkage, int number, Touch places[TOUCH_CORNERS]);

// The pose of a pin in its hole, with the velocity of its centre less that of the hole's, m/s.
static inline TouchPose touch_pose_in_hole(const PinHole *pin, Vec2 velocity)
{
    return (TouchPose){
        .offset = pin->eccentricity,
        .velocity = velocity,
        .gap = pin->gap,
        .has_normal = pin->has_normal,
        .normal = pin->normal,
        .approach_speed = pin->approach_speed,
    };
}

// The pose of a place whose bodies move so.
TouchPose touch_pose(const Linkage *linkage, const Touch *place, const Motion *motions);

// A pin in a slot in the slot's own axes, which are its rows in the response: x across it, y along
// it. They turn with body a.
typedef struct TouchSlot {
    Vec2 across;   // unit, in the world; along it is perp of that
    Vec2 position; // m, of the pin's centre from the slot's middle
    Vec2 rate;     // m/s
} TouchSlot;

TouchSlot touch_in_slot(Vec2 offset, Vec2 velocity, Vec2 across, double omega_a);

// The same of circles, lines and slots from what it is made of: the offset and the velocity, and of
// a line or slot its normal in the world and the angular velocity of body a, rad/s.
TouchPose touch_pose_of(const Touch *place, Vec2 offset, Vec2 velocity, Vec2 line, double omega_a);

// The same of a cam, with the unit vectors in the world from which its profile's angles count and
// in which a flat faces, and the angular velocities of both bodies, rad/s.
TouchPose touch_pose_on_cam(const Touch *place, Vec2 zero, Vec2 facing, Vec2 offset, Vec2 velocity,
                            const double omegas[2]);

// The direction across a slot, unit, in the world.
Vec2 touch_across(const Linkage *linkage, const Touch *place, const Motion *motions);

// The point at which the force acts, seen from the anchor on body a and from that on body b, m.
// Without friction the anchors themselves serve as well where both are circles.
void touch_points(const Touch *place, const TouchPose *pose, Vec2 *from_a, Vec2 *from_b);

// How fast the point of body b at which the force acts moves against that of body a, m/s, along the
// normal turned by a quarter turn.
double touch_sliding(const Linkage *linkage, const Touch *place, const TouchPose *pose,
                     const Motion *motions);

// How fast the normal of a cam turns, rad/s, and how fast the point where it is met goes on body b
// along the normal turned by a quarter turn, m/s.
typedef struct TouchTravel {
    double turning;
    double along_b;
} TouchTravel;

TouchTravel touch_travel(const Linkage *linkage, const Touch *place, const TouchPose *pose,
                         const Motion *motions);

// Prepares the response of a linkage with its places, in their order; where there is friction, with
// the turns that it acts in.
void touch_response(const Linkage *linkage, const Touch *places, size_t count, bool has_friction,
                    Response *response);

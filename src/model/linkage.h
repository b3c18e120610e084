// A linkage as data: rigid bodies with mass properties, the joints and springs between them, and
// what drives it. It moves in the plane, or in space where the case asks for it.
//
// Coordinates: a body's frame has its origin at the centre of mass; its x axis runs along the link.
// The ground is no body; it has the number LINKAGE_GROUND and the fixed frame of the world, y up.
#pragma once

#include "base/cam.h"
#include "base/drive.h"
#include "base/err.h"
#include "base/force_curve.h"
#include "base/load_table.h"
#include "base/mesh.h"
#include "base/vec2.h"
#include "base/vec3.h"
#include "kernel/bristle.h"
#include "kernel/contact_state.h"
#include "model/joint.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    LINKAGE_GROUND = -1,
    LINKAGE_NAME_SIZE = 48,
    LINKAGE_DRIVE_MAX = 8,
};

// Of a clearance: how much deeper than its wall something may start that is to touch it, for the
// difference of two sizes is rounded.
static const double LINKAGE_SEATED = 1e-9;

// How a body moves at one instant, in the world's frame.
typedef struct Motion {
    Vec2 position;     // of the centre of mass, m
    double angle;      // rad, counter-clockwise, not wrapped
    Vec2 velocity;     // m/s
    double omega;      // rad/s
    Vec2 acceleration; // m/s^2
    double alpha;      // rad/s^2
} Motion;

// What a body has only in space; see model/space.h. Inertias are about the centre of mass, kg m^2,
// in the body's frame.
typedef struct BodySpace {
    double inertia_x; // moments of inertia about the body's x and y axes
    double inertia_y;
    double product_xy; // products of inertia: sum of m x y, m x z, m y z over its points
    double product_xz;
    double product_yz;
    double height;     // m, z of the centre of mass at time zero
    double velocity_z; // m/s, at time zero
    double omega_x;    // rad/s, at time zero, along the world's axes
    double omega_y;
    // Where the joints' points and axes are in the body is said by Body.start and the height above.
    // A run that is continued begins elsewhere:
    bool is_elsewhere;
    Vec3 position; // m, of the centre of mass, at time zero
    Quat turn;     // from the body's frame to the world's
} BodySpace;

typedef struct Body {
    char name[LINKAGE_NAME_SIZE];
    double mass;    // kg
    double inertia; // kg m^2, about the centre of mass, about the axis normal to the plane; with
                    // the rotor of a motor that turns it
    double own_inertia; // kg m^2, likewise, as the case gives it: without that
    Motion start;       // at time zero, with every joint ideal unless the case says otherwise
    BodySpace space;
} Body;

// The sizes of a pin in its hole.
typedef struct Clearance {
    double hole_radius;  // m
    double pin_radius;   // m
    double width;        // m, the length over which pin and hole touch
    double eye_radius;   // m, of the outside of the eye around the hole; 0: twice that of the hole
    double modulus[2];   // Pa, of the materials of hole and pin; 0: that of the scenario's
    double poisson[2];   // 1, likewise Poisson's ratios
    Vec2 start;          // eccentricity at time zero: pin centre minus hole centre, m, world frame
    bool is_pin_assumed; // whether nobody gave the size of the pin
} Clearance;

// The sizes of a block between its guides. The block's middle is the anchor on body b; the guides'
// middle line goes through the anchor on body a. Guides are as long as they need to be. With the
// height below the opening the block is between the guides; with the height above it, it is a
// sleeve round a rod: `opening` is the rod's thickness, `height` the width of the sleeve's own
// opening.
typedef struct Guide {
    double opening; // m, from one guide to the other
    double height;  // m, of the block, across the guides
    double length;  // m, of the block, along the guides: its four corners are what touches
    Vec2 start;     // at time zero: x the distance of the block's middle from the middle line, m,
                    // y its tilt, rad; both as in the joint's rows (model/joint_rows.h)
} Guide;

// The sizes of a stop. The normal of a line is Joint.direction and points away from the wall; of a
// cam the profile's angles count from there.
typedef struct Stop {
    bool is_disc;    // whether body a carries a disc about its anchor; else a line through it
    double radius_a; // m, of that disc; of a cam how far it reaches; of a slot half its width
    double radius_b; // m, of the disc about the anchor of body b; 0: a point
    double slot;     // m, of a slot of body a about its anchor, at right angles to the normal:
                     // between the centres of the arcs at its ends; 0: none
    size_t cam;      // of a cam that body a carries about its anchor: which of the linkage's
                     // profiles, counted from 1; 0: none
    double hump;     // m, of a cam: the least radius of curvature where it is convex
    bool is_flat;    // whether body b meets the cam with a line through its anchor
    double facing;   // rad, in body b's frame: the direction of that line towards the cam
} Stop;

typedef enum LimitKind {
    LIMIT_NONE,
    LIMIT_BACKLASH, // flanks to both sides, with a gap between them
    LIMIT_STOPS,    // stops at two values, or at one
} LimitKind;

// What limits the coordinate of a joint (model/coordinate.h). Beyond the limits flanks or stops
// press it back.
typedef struct Limits {
    LimitKind kind;
    double backlash; // rad or m, from flank to flank, 0 or more
    double start;    // rad or m: of a backlash, coordinate less the middle of the gap at time zero
    double middle;   // rad or m: the coordinate in the middle of the gap, set where bodies start
    double low;      // rad or m, of LIMIT_STOPS; -INFINITY: none
    double high;     // rad or m; INFINITY: none
} Limits;

// What a joint with play has of its own in place of what the contact's options say. Of a joint
// whose limited coordinate is an angle forces are torques, N m, and lengths angles, rad.
typedef struct JointContact {
    double stiffness;     // N/m^exponent; 0: none of its own
    double exponent;      // 1, of that stiffness
    double for_depth;     // m (rad of an angle): the depth that it was given for; 0: it was not
    double restitution;   // 1
    double viscous;       // N s/m: its damping is viscous, with this; 0: none of its own
    double full_depth;    // m (rad of an angle): and grows up to this depth; 0: none of its own
    double dissipation;   // s/m (s/rad of an angle): its damping is a dissipation, with this; 0:
                          // none of its own
    double gap_damping;   // N s/m (N m s/rad of an angle), of a damper that acts in the gap, too;
                          // 0: there is none
    double friction;      // 1, Coulomb's coefficient
    bool has_restitution; // whether it has its own
    bool has_friction;    // likewise
} JointContact;

// The friction of a joint (model/joint_friction.h), beside JointContact.friction. A zero stands for
// its default.
typedef struct JointFriction {
    BristleLaw law;    // that of the contact, unless:
    bool has_law;      // it has its own
    double steady;     // of an ideal joint, N m of a pivot, N of a slider: instead of mu times what
                       // presses
    double radius;     // m, of an ideal pivot's pin
    double length;     // m, of an ideal slider's guide, over which it takes a moment; 0: none does
    double speed;      // m/s, sliding speed over which it sets in, or falls to that of sliding
    double ratio;      // 1, static over sliding friction
    double presliding; // m, how far a bristle bends before it slides
    double damping;    // 1, damping ratio with which it does
} JointFriction;

enum { JOINT_PLACES = 4 }; // at which a joint with play can touch, at most

// What a joint has only in space.
typedef struct JointSpace {
    double height;          // m, z of its middle at time zero
    Vec3 axis;              // unit, at time zero
    double axial_clearance; // m, by which a pin with play can slide along the hole to either side
                            // before a collar stops it; 0: no collars
} JointSpace;

typedef struct Joint {
    char name[LINKAGE_NAME_SIZE];
    JointKind kind;
    int body_a;        // carries the hole; number of a body or LINKAGE_GROUND
    int body_b;        // carries the pin
    bool is_apart;     // whether the case says of each anchor where it is, of a stop or of a pin
                       // that stands apart from its hole's centre; else they start at one point
    Vec2 anchor_a;     // hole centre in body a's frame, m
    Vec2 anchor_b;     // pin centre in body b's frame, m
    double direction;  // rad, in body a's frame: of the line or the guides; of a stop's normal
    double held_angle; // rad: angle of body b less that of body a where what slides is not tilted
    // sizes of what touches in it (joint_touches)
    Clearance clearance;
    Guide guide;
    Stop stop;
    Gear gear;
    Limits limits; // of a joint with a coordinate; teeth always have some
    JointContact contact;
    JointFriction friction;
    // what its contacts bring along at time zero, in the order of its places (contact/touch.h; in
    // space contact/pin_space.h and the ends of an angle); all zero: none touches yet
    ContactState contacts[JOINT_PLACES];
    JointSpace space;
} Joint;

// A spring with a damper along the line between two points. Its tension is
//     stiffness (distance - length) + damping (rate of the distance)
typedef struct Spring {
    char name[LINKAGE_NAME_SIZE];
    int body_a; // number of a body or LINKAGE_GROUND
    int body_b;
    Vec2 anchor_a; // in body a's frame, m
    Vec2 anchor_b;
    double stiffness; // N/m
    double length;    // m, of the relaxed spring
    double damping;   // N s/m
} Spring;

// A spring with a damper that turns the two bodies of a joint against each other; see
// linkage_turning for its angle.
typedef struct TorsionSpring {
    char name[LINKAGE_NAME_SIZE];
    int joint;        // number, of any kind
    double stiffness; // N m/rad
    double angle;     // rad, of the relaxed spring
    double damping;   // N m s/rad
} TorsionSpring;

enum { BUSHING_ROWS = 3 }; // of a bushing: along its x axis, along its y axis, and by angle

// Holds two bodies at a point by springs and dampers in two directions and by angle, as rubber does
// (model/bushing.h). Its axes turn with body a.
typedef struct Bushing {
    char name[LINKAGE_NAME_SIZE];
    int body_a; // carries its axes; number of a body or LINKAGE_GROUND
    int body_b;
    bool is_apart; // whether the case says of each anchor where it is; else they start at one point
    Vec2 anchor_a; // in body a's frame, m; it is relaxed where both are at one point
    Vec2 anchor_b;
    double direction;           // rad, of its x axis in body a's frame
    double angle;               // rad, where it is relaxed: of body b less that of body a
    Vec2 stiffness;             // N/m, along its axes
    Vec2 damping;               // N s/m
    double torsional_stiffness; // N m/rad
    double torsional_damping;   // N m s/rad
    ForceCurve force_x;         // what pulls it back over its deflection, in place of a stiffness
    ForceCurve force_y;
    ForceCurve torque;
    ForceCurveShape interpolation; // of these
} Bushing;

// Pushes the turned body of a joint, and the other one the other way (linkage_turning), by a torque
// over time. At a prismatic joint it is a force on body b along the joint's line, at the anchor of
// body b, and the other way on body a. With the joint's angle phi and its rate,
//     M(t) + stiffness (phi_d(t) - phi) + slope (omega_d(t) - omega),  at most the limit in size,
// so that it also is a motor with a straight line of torque over speed (no phi_d), or a soft drive
// that follows an angle phi_d(t) through a belt or a controller.
typedef struct Torque {
    int joint;        // number of the joint, which is ideal
    TimeTable table;  // N m, counter-clockwise positive, or N; without points there is no torque
    double slope;     // N m s/rad
    double stiffness; // N m/rad
    Driver followed;  // phi_d and omega_d; where it is not present both are 0
    double no_load;   // rad/s, of a motor: where its torque is 0; 0: it is none
    double limit;     // N m, of a soft drive: the largest torque to either side; 0: none
    double inertia;   // kg m^2, of its rotor, which turns with the turned body
} Torque;

// What a load acts on, what its value is over, and what its direction turns with.
typedef enum LoadKind { LOAD_FORCE, LOAD_TORQUE, LOAD_ALONG } LoadKind;
typedef enum LoadOver { LOAD_OVER_TIME, LOAD_OVER_CRANK, LOAD_OVER_POSITION } LoadOver;
typedef enum LoadFrame { LOAD_IN_WORLD, LOAD_IN_BODY } LoadFrame;

// A load (model/loads.h).
typedef struct Load {
    char name[LINKAGE_NAME_SIZE];
    LoadKind kind;
    int body;         // of a force or torque on one
    Vec2 anchor;      // m, in its frame, where a force acts
    double direction; // rad, of a force, in the frame that it turns with
    LoadFrame frame;
    int joint; // of LOAD_ALONG: along whose coordinate it acts
    LoadOver over;
    double area;  // m^2, of a force that was given as a pressure on it; 0: it was not
    double shift; // s or rad, by which time or the crank's angle counts more: a run that is
                  // continued has begun earlier
    LoadTable table;
} Load;

// Its arrays are as long as the linkage needs. An assignment shares them: it is for another driver
// or other options of the same bodies. What is to have other bodies or joints needs linkage_copy.
typedef struct Linkage {
    bool is_spatial; // whether bodies leave the plane: model/space.h
    size_t body_count;
    Body *bodies; // owned, like the arrays below, by whom linkage_create gave them to
    size_t joint_count;
    Joint *joints;
    size_t gap_damper_count; // how many of the joints have a gap damping
    size_t spring_count;
    Spring *springs;
    size_t torsion_count;
    TorsionSpring *torsions;
    size_t bushing_count;
    Bushing *bushings;
    size_t load_count;
    Load *loads;
    Driver driver; // the crank's: angles of the crank are those of its body
    size_t further_count;
    Driver *further; // drives beside it, at other joints
    size_t profile_count;
    Profile *profiles; // of cams and gears
    Torque torque;     // instead of a driver
} Linkage;

// How many of each a linkage has room for.
typedef struct LinkageRoom {
    size_t bodies;
    size_t joints;
    size_t springs;
    size_t torsions;
    size_t bushings;
    size_t loads;
    size_t further;
    size_t profiles;
} LinkageRoom;

// A linkage without bodies and joints, with room for so many, all zero. For linkage_free.
Linkage linkage_create(LinkageRoom room);

// One with arrays of its own, of the same contents. For linkage_free.
Linkage linkage_copy(const Linkage *linkage);

// Frees the arrays; the linkage is then empty.
void linkage_free(Linkage *linkage);

// Whether something of a pair of gears changes with how they are turned.
static inline bool linkage_has_teeth_tables(const Joint *joint)
{
    return joint->gear.error > 0 || joint->gear.relief > 0;
}

// The profile of a cam; NULL of other joints.
static inline const Profile *linkage_profile(const Linkage *linkage, const Joint *joint)
{
    return joint->stop.cam > 0 ? &linkage->profiles[joint->stop.cam - 1] : NULL;
}

// Whether body a has a slot, in which a pin of body b plays.
static inline bool linkage_has_slot(const Joint *joint)
{
    return joint_has_disc(joint->kind) && joint->stop.slot > 0.0;
}

// One side of a joint: 0 that of body a, 1 that of body b.
typedef struct JointEnd {
    int body;
    Vec2 anchor;
} JointEnd;

static inline JointEnd linkage_end(const Joint *joint, int side)
{
    return side == 0 ? (JointEnd){joint->body_a, joint->anchor_a}
                     : (JointEnd){joint->body_b, joint->anchor_b};
}

// Whether bodies touch in a joint: a pin in its hole, a block between its guides, a stop, teeth, or
// what limits the coordinate of an ideal joint.
static inline bool linkage_has_play(const Joint *joint)
{
    return !joint_is_ideal(joint->kind) || joint->limits.kind != LIMIT_NONE;
}

// Whether two joints are pins in holes of the same two bodies, so that they share what these bear.
static inline bool linkage_shares_bodies(const Joint *joint, const Joint *other)
{
    const bool is_same = joint->body_a == other->body_a && joint->body_b == other->body_b;
    const bool is_turned = joint->body_a == other->body_b && joint->body_b == other->body_a;
    return joint_has_hole(joint->kind) && joint_has_hole(other->kind) && (is_same || is_turned);
}

// The name of a body for people; "ground".
static inline const char *linkage_body_name(const Linkage *linkage, int body)
{
    return body == LINKAGE_GROUND ? "ground" : linkage->bodies[body].name;
}

// Whether a contact of a joint is under way at time zero.
static inline bool linkage_starts_touching(const Joint *joint)
{
    bool is_touching = false;
    for (size_t i = 0; i < JOINT_PLACES; i++) {
        is_touching = is_touching || joint->contacts[i].is_touching;
    }
    return is_touching;
}

// Whether what touches in a joint are flanks or stops that turn it: its contact has torques, N m,
// and angles, rad, in place of forces and lengths.
static inline bool linkage_is_torsional(const Joint *joint)
{
    return joint_has_angle(joint->kind) && joint->limits.kind != LIMIT_NONE;
}

// The least gap of a block's corners to the guides (of a sleeve's to the rod), m, negative inside
// the metal: the block's middle at a distance from the middle line, m, and tilted, rad.
double linkage_guide_gap(const Guide *guide, double offset, double tilt);

// The tilt at which opposite corners of a block on the middle line touch, rad: it cannot tilt
// further. A half turn where it is short enough to turn between its guides.
double linkage_guide_tilt(const Guide *guide);

// How far the middle of a pin or block can go from the middle of its hole or guides before it
// touches, not tilted: hole radius minus pin radius, or half of what a block's height is less than
// the opening (of a sleeve more), m; 0 of other kinds.
double linkage_radial_clearance(const Joint *joint);

// How many drives prescribe the motion of a body each, and which: the crank's is the first.
static inline size_t linkage_drive_count(const Linkage *linkage)
{
    return linkage->driver.is_present ? 1 + linkage->further_count : 0;
}

static inline const Driver *linkage_drive(const Linkage *linkage, size_t number)
{
    return number == 0 ? &linkage->driver : &linkage->further[number - 1];
}

// The body that a drive turns.
static inline int linkage_drive_body(const Linkage *linkage, size_t number)
{
    return linkage->joints[linkage_drive(linkage, number)->joint].body_b;
}

// The number of the drive that turns a body or holds a joint, or -1.
static inline int linkage_drive_of_body(const Linkage *linkage, int body)
{
    const size_t count = linkage_drive_count(linkage);
    for (size_t i = 0; i < count; i++) {
        if (linkage_drive_body(linkage, i) == body) {
            return (int)i;
        }
    }
    return -1;
}

int linkage_drive_of_joint(const Linkage *linkage, size_t joint);

// Whether a drive prescribes how a body moves.
static inline bool linkage_is_driven(const Linkage *linkage, int body)
{
    return linkage_drive_of_body(linkage, body) >= 0;
}

// The states of all drives at a time; of the pieces that hold from a time on, which is no later.
void linkage_drives_since(const Linkage *linkage, double from_s, double time_s,
                          DriveState states[LINKAGE_DRIVE_MAX]);

// The first kink of any drive after a time, s; INFINITY where there is none.
double linkage_next_kink(const Linkage *linkage, double time_s);

// Whether a joint holds its bodies in its rows and is not a drive's: one that constrains how bodies
// move.
bool linkage_is_ideal(const Linkage *linkage, size_t joint);

// The body that a joint turns and the one that it turns against: its bodies b and a, but the other
// way round where b is the ground. The joint's angle is that of the first less that of the second.
void linkage_turning(const Linkage *linkage, int joint, int *turned, int *against);

// The number of the crank, the body that the first drive turns, or LINKAGE_GROUND where there is no
// driver.
int linkage_driven_body(const Linkage *linkage);

// Angle of the driven body at a time, rad; 0 where there is no driver.
double linkage_crank_angle(const Linkage *linkage, double time_s);

// Writes when something happened, for people: "at 1.5 ms, crank angle 9 deg", without the angle
// where there is no driver.
enum { LINKAGE_INSTANT_SIZE = 64 };
void linkage_describe_instant(const Linkage *linkage, double time_s,
                              char text[LINKAGE_INSTANT_SIZE]);

// Time of one turn of the driver, or of a period of one whose speed repeats, s; 0 where there is no
// driver, or it does not repeat. Loads may take longer to be the same again: model/common_period.h.
double linkage_period(const Linkage *linkage);

// How far a body's points go from its centre of mass, m: the distance of its furthest joint, at
// least its radius of gyration; of a block between guides with its corners, of a stop with its
// disc.
double linkage_reach(const Linkage *linkage, int body);

// The same of all bodies, in time proportional to the linkage.
void linkage_reaches(const Linkage *linkage, double *reaches);

// The number of a body or joint by its name, or -1.
int linkage_find_body(const Linkage *linkage, const char *name);
int linkage_find_joint(const Linkage *linkage, const char *name);

// Writes how all bodies move at time zero.
void linkage_start(const Linkage *linkage, Motion *motions);

// A point given in a body's frame (or the ground's), in the world's frame, and its velocity.
Vec2 linkage_point(const Motion *motions, int body, Vec2 local);
Vec2 linkage_point_velocity(const Motion *motions, int body, Vec2 local);

// Where the second anchor of a joint (the pin) is against the first (the hole), and how it moves.
typedef struct JointGap {
    Vec2 position; // m
    Vec2 velocity; // m/s
} JointGap;

JointGap linkage_joint_gap(const Linkage *linkage, const Motion *motions, int joint);

// Checks what must hold for any linkage: mass and inertia positive and finite, names unique,
// joints and springs between two different existing bodies, pin smaller than hole, driver at an
// ideal joint with the ground, a torque's times increasing. Fails with ERR_CASE and the name of the
// offender.
bool linkage_check(const Linkage *linkage, Err *err);

// Kinetic energy of all bodies, J, sum (m v^2 + I w^2) / 2; and potential energy in gravity,
// m/s^2, zero at the ground frame's origin, -sum m g . x.
double linkage_kinetic_energy(const Linkage *linkage, const Motion *motions);
double linkage_potential_energy(const Linkage *linkage, const Motion *motions, Vec2 gravity);

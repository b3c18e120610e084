// A planar mechanism with play, in quadruple precision and maximal coordinates: its equations of
// motion, its joints' gaps, and the way back onto the ideal joints.
//
// Written apart from the program's own solvers and sharing none of their code: only the scenario's
// data come from there. gcc with libquadmath.
#pragma once

#include "model/kinematics.h"
#include "quad_law.h"

enum { QUAD_COORDINATE_MAX = 3 * KINEMATICS_BODY_MAX };

typedef struct QuadVec {
    Quad x;
    Quad y;
} QuadVec;

typedef struct QuadBody {
    Quad mass;    // kg
    Quad inertia; // kg m^2
} QuadBody;

// When a joint's two rows hold: those of a pin in its hole and of a block between its guides are
// where the run starts.
typedef enum QuadHeld {
    QUAD_HELD_NEVER,
    QUAD_HELD_ALWAYS,
    QUAD_HELD_AT_START,
} QuadHeld;

typedef enum QuadShape {
    QUAD_HOLE, // a pin on body b in a hole of body a
    QUAD_DISC, // a disc on body b outside a disc of body a
    QUAD_LINE, // a disc or point on body b at a line of body a
} QuadShape;

// A joint of the linkage, or behind those a corner of a block between its guides.
typedef struct QuadJoint {
    QuadHeld held;
    bool is_sliding; // whether its rows are a distance from a line and a tilt
    bool has_play;   // whether bodies touch in it
    QuadShape shape; // where they do
    int body_a;      // carries the hole; LINKAGE_GROUND for the ground
    int body_b;      // carries the pin
    QuadVec anchor_a;
    QuadVec anchor_b;
    Quad direction;  // rad, in body a's frame: of the line that it slides on, or of the normal of
                     // the line that it touches
    Quad held_angle; // rad, of body b against body a where they slide
    Quad clearance;  // m, radial; the sum of the radii outside
    Quad radius_a;   // m, of hole or disc
    Quad radius_b;   // m
    QuadLaw law;     // of the contact
    QuadVec start;   // of the rows at time zero: m, or m and rad
} QuadJoint;

// The contact force is F = F_el(d) (1 + chi d'/v0) + c d', v0 = max(share * d' at the onset,
// floor), and friction on the pin is -mu F tanh(v_t / v_s) along the wall, at the wall.
typedef struct QuadProblem {
    size_t body_count;
    QuadBody bodies[KINEMATICS_BODY_MAX];
    size_t joint_count;
    QuadJoint joints[KINEMATICS_JOINT_MAX];
    int driver_joint;                         // the joint about which the driven body turns, or -1
    int driven_body;                          // moves as prescribed, or LINKAGE_GROUND
    Quad drive_speed;                         // rad/s
    Quad drive_start;                         // rad
    QuadVec gravity;                          // m/s^2
    Quad hysteresis;                          // chi, 1
    Quad impact_speed_floor;                  // m/s
    Quad impact_speed_share;                  // 1; anything else is a control that must be seen
    Quad friction;                            // mu, 1
    Quad friction_speed;                      // v_s, m/s
    Quad start_position[QUAD_COORDINATE_MAX]; // x, y, phi of each body
    Quad start_velocity[QUAD_COORDINATE_MAX];
} QuadProblem;

// What a joint with play is doing; it stays so between two events.
typedef enum QuadMode {
    QUAD_FREE,    // no overlap
    QUAD_PRESSED, // F > 0
    QUAD_CLAMPED, // overlap, but the damping would pull: F = 0
} QuadMode;

typedef struct QuadContacts {
    QuadMode mode[KINEMATICS_JOINT_MAX];
    Quad speed[KINEMATICS_JOINT_MAX]; // v0, m/s, of a joint that is not free
} QuadContacts;

// How two bodies stand where they can touch.
typedef struct QuadGap {
    Quad penetration; // d, m; negative in the free play
    Quad rate;        // d', m/s
    QuadVec outward;  // unit, against the force on body b
    QuadVec arm_a;    // from the centre of mass of body a to where they touch, m
    QuadVec arm_b;    // likewise of body b
} QuadGap;

// The problem of a scenario. With a driver the start
// is moved onto the closed linkage with each pin at its start in the hole; without one the bodies
// start as they stand.
QuadProblem quad_problem(const Scenario *scenario);

// Puts the driven body, if there is one, into coordinates and velocities at a time, s.
void quad_problem_drive(const QuadProblem *problem, Quad time, Quad *position, Quad *velocity);

// The accelerations of every body; the driven one must stand where its drive puts it.
void quad_problem_accelerate(const QuadProblem *problem, const QuadContacts *contacts,
                             const Quad *position, const Quad *velocity, Quad *acceleration);

QuadGap quad_problem_gap(const QuadProblem *problem, size_t joint, const Quad *position,
                         const Quad *velocity);

// Positive while a joint that is not free presses, and zero where its force ends: 1 + chi d'/v0,
// or with a viscous damper d' + F_el / c, m/s.
Quad quad_problem_margin(const QuadProblem *problem, const QuadContacts *contacts, size_t joint,
                         const QuadGap *gap);

// Moves the free bodies onto the ideal joints, positions and velocities, and returns the largest
// distance, m, by which an ideal joint stood open before.
Quad quad_problem_project(const QuadProblem *problem, Quad *position, Quad *velocity);

// Kinetic, potential and elastic energy of the bodies that are not driven, J.
Quad quad_problem_energy(const QuadProblem *problem, const QuadContacts *contacts,
                         const Quad *position, const Quad *velocity);

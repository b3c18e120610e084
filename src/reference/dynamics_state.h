// The equations of motion of a linkage with play in the plane, and everything at one instant.
#pragma once

#include "contact/touch.h"
#include "model/forces.h"
#include "reference/articulated.h"
#include "reference/system.h"
#include "reference/tree_state.h"

// Where a contact's bodies touch.
typedef struct PlanePlace {
    Touch touch;
    int pair;         // of the tree: the ends that its distance is measured between
    bool acts_beside; // whether the force's line may pass beside these ends: on a line, between
                      // teeth, and with friction
    double end; // rad or m, of a turn or teeth: gap = sign of the place (tree_coordinate) - end
} PlanePlace;

// A contact's quantities at one instant.
typedef struct ContactForce {
    Press press;
    TouchPose pose;
    Vec2 force;    // N, on body b, friction included
    double couple; // N m, on body b, of a turn, which has no force
} ContactForce;

// Everything at one instant.
typedef struct DynamicsState {
    SystemState shared;     // the first
    TreeState tree;         // accelerations filled in
    ContactForce *contacts; // by contact
    Vec2 *reactions;        // N, on body b, of ideal joints
    double *couples;        // N m, on body b, of prismatic joints, about its anchor
    double drive_power;     // W, of drive or torque
    double damping_power;   // W, that the dampers take
} DynamicsState;

// The forces on the bodies at one instant, while they are gathered.
typedef struct Loads {
    ArticulatedPush *pushes; // by body: at the centre, and the moment about it
    double driven_power;     // W, of all forces on the driven body but the drive's
    Vec2 driven_force;       // N, their sum
} Loads;

// The ways in which a contact pushes: along x, along y, and by friction.
enum { DYNAMICS_PUSHED = 3 };

// Room to work in.
typedef struct DynamicsRoom {
    DynamicsState *state;
    Loads loads;
    ArticulatedPush *zeros; // by body
    BodyLoad *added;        // by body
    double *sides;          // of the loops' rows
    double *solved;         // by coordinate, then by row of a loop
    double *closed;         // an integrator's vector
    // of the slopes, by coordinate
    Vec2 *row;
    double *arms;
    double *pushed[DYNAMICS_PUSHED];
} DynamicsRoom;

typedef struct Hinged Hinged; // of reference/hinged.h

typedef struct Dynamics {
    System system; // the first
    Tree tree;
    Articulated *articulated; // owned
    Hinged *hinged;           // owned; NULL where it has no such rates
    void *memory;             // owned; where all arrays are
    PlanePlace *places;       // by contact
    double *reach;            // m, of each body's points
    double *weights;          // N, of each body
    bool has_forces;          // whether springs, dampers or a torque act
    bool may_branch;          // whether loops move freely, and may come to a change point
    double start_energy;      // J, of such a linkage: what it has, less what it was given
    double greatest_energy;   // J, kinetic, so far
    DynamicsRoom room;
} Dynamics;

// The equations of motion of a linkage with play in the plane, and everything at one instant.
#pragma once

#include "contact/touch.h"
#include "reference/system.h"
#include "reference/tree_state.h"

// Where a contact's bodies touch.
typedef struct PlanePlace {
    Touch touch;
    int pair;         // of the tree: the ends that its distance is measured between
    bool acts_beside; // whether the force's line may pass beside these ends: on a line, and with
                      // friction
} PlanePlace;

// A contact's quantities at one instant.
typedef struct ContactForce {
    Press press;
    TouchPose pose;
    Vec2 force; // N, on body b, friction included
} ContactForce;

typedef struct Dynamics {
    System system; // the first
    Tree tree;
    PlanePlace places[TOUCH_MAX];   // by contact
    double reach[LINKAGE_BODY_MAX]; // m, of each body's points
    bool has_forces;                // whether springs, dampers or a torque act
    bool may_branch;                // whether loops move freely, and may come to a change point
    double start_energy;            // J, of such a linkage: what it has, less what it was given
    double greatest_energy;         // J, kinetic, so far
} Dynamics;

// Everything at one instant.
typedef struct DynamicsState {
    SystemState shared;                // the first
    TreeState tree;                    // accelerations filled in
    ContactForce contacts[TOUCH_MAX];  // by contact
    Vec2 reactions[LINKAGE_JOINT_MAX]; // N, on body b, of ideal joints
    double couples[LINKAGE_JOINT_MAX]; // N m, on body b, of prismatic joints, about its anchor
    double drive_power;                // W, of drive or torque
    double damping_power;              // W, that the dampers take
} DynamicsState;

// The equations of motion of a linkage with play in the coordinates of its tree, contacts as
// smooth forces while their mode is frozen.
#pragma once

#include "contact/force_law.h"
#include "contact/pin_hole.h"
#include "model/scenario.h"
#include "model/trajectory.h"
#include "reference/tree.h"

// What a joint with play is doing. It changes at events only.
typedef enum ContactMode {
    CONTACT_APART,    // the pin is within its play
    CONTACT_PRESSING, // it overlaps the wall and is pressed
    CONTACT_SLACK,    // it overlaps the wall, but leaves it faster than the spring follows
} ContactMode;

typedef struct DynamicsContact {
    int joint;
    ForceLaw law;
    double radial_clearance; // m
    double hole_radius;      // m
    ContactMode mode;
    double impact_speed; // m/s, closing speed when the contact under way began
    double damping_rate; // s/m, chi / v0 of it, v0 not below the law's floor
} DynamicsContact;

// A contact's quantities at one instant.
typedef struct ContactForce {
    PinHole pose;
    double elastic;        // N, of the law's spring, continued as an odd function below zero depth
    double normal;         // N, what presses in the present mode
    double pressing;       // N, what would press in the pressing mode, not clamped at zero
    double release;        // turns negative where a pressing contact goes slack
    Vec2 force;            // N, on the pin, friction included
    double damping_power;  // W, lost along the normal
    double friction_power; // W, lost in sliding
} ContactForce;

typedef struct Dynamics {
    const Scenario *scenario;
    Tree tree;
    size_t contact_count;
    DynamicsContact contacts[LINKAGE_JOINT_MAX];
} Dynamics;

// Everything at one instant.
typedef struct DynamicsState {
    TreeState tree;                           // accelerations filled in
    ContactForce contacts[LINKAGE_JOINT_MAX]; // by contact
    Vec2 reactions[LINKAGE_JOINT_MAX];        // N, on body b, of ideal joints
    double drive_power;                       // W
} DynamicsState;

// The parts of the integrator's state: coordinates, their rates, and what is added up over time.
typedef enum DynamicsSum {
    DYNAMICS_DRIVE_WORK, // J
    DYNAMICS_DISSIPATED, // J
    DYNAMICS_FRICTION,   // J
    DYNAMICS_IMPULSES,   // N s, of each contact from here on
} DynamicsSum;

size_t dynamics_size(const Dynamics *dynamics);
size_t dynamics_sum_index(const Dynamics *dynamics, size_t sum);

// Fails with ERR_CASE where a contact law does not fit a joint.
bool dynamics_init(const Scenario *scenario, Dynamics *dynamics, Err *err);

// Times, s, and coordinates are those since the base of the tree.
//
// The state at a time from the integrator's vector. Returns false where the accelerations are not
// determined.
bool dynamics_evaluate(const Dynamics *dynamics, double since_s, const double *y,
                       DynamicsState *state);

// Rates of the integrator's vector; NaN where they are not determined. The context is a Dynamics.
void dynamics_rates(double since_s, const double *y, double *rates, void *context);

// One contact at a time, for events: cheaper than the whole state.
ContactForce dynamics_contact(const Dynamics *dynamics, size_t contact, double since_s,
                              const double *y);

// Fails with ERR_SOLVER where a pin is deeper in its wall than a share of what its law knows.
bool dynamics_check_depth(const Dynamics *dynamics, const DynamicsState *state, double share,
                          Err *err);

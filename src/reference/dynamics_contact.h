// The forces of the contacts in the coordinates of a tree.
#pragma once

#include "contact/force_law.h"
#include "contact/pin_hole.h"
#include "model/scenario.h"
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

// One contact's quantities from the state of the tree.
ContactForce dynamics_contact_find(const DynamicsContact *contact, const ContactOptions *options,
                                   const Tree *tree, const TreeState *state);

// From the centres of hole and pin to the point of the wall where they touch. Without friction the
// force's line passes through both centres, and those serve as well: zero.
void dynamics_contact_points(const DynamicsContact *contact, const ContactOptions *options,
                             const PinHole *pose, Vec2 *from_hole, Vec2 *from_pin);

// Velocity of the point of an end's body that lies beside the end.
Vec2 dynamics_contact_velocity(const Tree *tree, const TreeState *state, int end, Vec2 beside);

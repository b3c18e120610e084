// The forces of the contacts in the coordinates of a tree.
#pragma once

#include "contact/pin_hole.h"
#include "model/scenario.h"
#include "reference/press.h"
#include "reference/tree.h"

// A contact's quantities at one instant.
typedef struct ContactForce {
    Press press;
    PinHole pose;
    Vec2 force; // N, on the pin, friction included
} ContactForce;

// One contact's quantities from the state of the tree.
void dynamics_contact_find(const Contact *contact, const ContactOptions *options, const Tree *tree,
                           const TreeState *state, ContactForce *force);

// From the centres of hole and pin to the point of the wall where they touch. Without friction the
// force's line passes through both centres, and those serve as well: zero.
void dynamics_contact_points(const Contact *contact, const ContactOptions *options,
                             const PinHole *pose, Vec2 *from_hole, Vec2 *from_pin);

// Velocity of the point of an end's body that lies beside the end.
Vec2 dynamics_contact_velocity(const Tree *tree, const TreeState *state, int end, Vec2 beside);

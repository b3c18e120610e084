// The forces of the contacts: what reference/dynamics.c needs of them.
#pragma once

#include "reference/dynamics.h"

// One contact's quantities from the state of the tree.
void dynamics_contact_find(const Dynamics *dynamics, size_t number, const TreeState *tree,
                           ContactForce *force);

// From the centres of hole and pin to the point of the wall where they touch. Without friction the
// force's line passes through both centres, and those serve as well: zero.
void dynamics_contact_places(const Dynamics *dynamics, const DynamicsContact *contact,
                             const PinHole *pose, Vec2 *from_hole, Vec2 *from_pin);

// Velocity of the point of an end's body that lies beside the end.
Vec2 dynamics_contact_velocity(const Tree *tree, const TreeState *state, int end, Vec2 beside);

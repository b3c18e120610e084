// The contact at one place of a joint with play; of a pin in its hole as the world's collider finds
// it.
#pragma once

#include "contact/onset.h"
#include "contact/tops.h"
#include "kernel/contact_state.h"
#include "kernel/force_law.h"
#include "ode/plane/world.h"

typedef struct ContactRow {
    ForceLaw law;
    double mass;       // kg, effective along the normal that it was worked out for
    double stiff_mass; // kg, with which the stiffest motion of the joint's places meets it
    Vec2 mass_normal;
    bool falls_back; // the map is not stable at this step: the row is the textbook's
    Onset onset;
    ContactState state; // touching: the present step has a row; of a contact that does not touch
                        // the speed is that at which it closes
    double depth;       // m, of the row, as the collider has it
    double share;       // 1, of the step in which the place overlaps
    double inside;      // m, depth where the bodies are, negative outside; of the row it may be
                        // another where the place overlaps in a part of the step alone
    double excess;      // m, by how much that is more than the exact penetration
    Vec2 normal;        // of the row: unit, direction of the force on body b
    Vec2 point;         // m, in the world, where the force acts
    Vec2 arms[2];    // m, from the joint's anchors on bodies a and b to where its force is said to
                     // act (ode/plane/world.h)
    Vec2 lever;      // m, from there to the point
    double damping;  // N s/m, of the row; not of CONTACT_POISSON
    Tops tops;       // of the contact under way, where positions stand at mid-step
    double pressing; // N, in the step: at a turn N m
    double closing;  // m/s, before the step, along the normal
    double faster;   // m/s, by how much that is more than the rate of the exact penetration
    double sliding;  // m/s, along the wall before the step, where there is friction
    double elastic;  // J, stored in the contact after the step
    double dissipated;          // J, lost along the normal in the step
    double friction;            // J, lost in sliding in the step
    dSurfaceParameters surface; // of CONTACT_POISSON, without friction
    dContact contact;           // as ODE is given it
    dJointFeedback feedback;
} ContactRow;

// Looks for the contact of a pair, and notes how it is, or that there is none; of a staggered world
// the speed at its onset is located between steps. Fills in the state of this place: eccentricity
// (the pose's offset), gap, and whether it touches.
void contact_row_find(ContactRow *row, const World *world, const WorldPair *pair, bool is_staggered,
                      double step_s, JointState *state);

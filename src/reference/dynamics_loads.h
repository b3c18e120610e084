// The forces on the bodies at one instant, while they are gathered.
#pragma once

#include "reference/dynamics_contact.h"
#include "reference/tree_line.h"

// A force on the body of an end, beside the end.
static inline void dynamics_load_end(const Tree *tree, const TreeState *state, int end, Vec2 beside,
                                     Vec2 force, Loads *loads)
{
    const int body = tree->end_bodies[end];
    if (body == LINKAGE_GROUND) {
        return;
    }
    if (body == tree->driven) {
        loads->driven_power += vec2_dot(force, dynamics_contact_velocity(tree, state, end, beside));
        loads->driven_force = vec2_add(loads->driven_force, force);
        return;
    }
    ArticulatedPush *push = &loads->pushes[body];
    push->force = vec2_add(push->force, force);
    push->moment += vec2_cross(vec2_add(state->arms[end], beside), force);
}

// A couple on a body.
static inline void dynamics_load_couple(const Tree *tree, const TreeState *state, int body,
                                        double couple, Loads *loads)
{
    if (body == tree->driven) {
        loads->driven_power += couple * tree_omega(state, body);
    } else if (body != LINKAGE_GROUND) {
        loads->pushes[body].moment += couple;
    }
}

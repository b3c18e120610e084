// The forces of the contacts in the coordinates of a tree.
#pragma once

#include "reference/dynamics_state.h"

// One contact's quantities from the state of the tree.
void dynamics_contact_find(const Dynamics *dynamics, size_t number, const TreeState *state,
                           ContactForce *force);

// The points of body a and of body b at which the force acts, seen from the ends of the contact's
// pair; of two circles without friction the ends themselves.
static inline void dynamics_contact_points(const PlanePlace *place, const TouchPose *pose,
                                           Vec2 *from_a, Vec2 *from_b)
{
    *from_a = *from_b = (Vec2){0.0, 0.0};
    if (place->acts_beside) {
        touch_points(&place->touch, pose, from_a, from_b);
    }
}

// Whether a contact's gap is that of an angle or of teeth.
static inline bool dynamics_contact_is_turn(const PlanePlace *place)
{
    return place->touch.shape == TOUCH_TURN || place->touch.shape == TOUCH_TEETH;
}

// The second rate of a contact's gap, m/s^2, after tree_accelerate.
double dynamics_contact_second(const Dynamics *dynamics, size_t number, const TreeState *state,
                               const TouchPose *pose);

// Velocity of the point of an end's body that lies beside the end.
static inline Vec2 dynamics_contact_velocity(const Tree *tree, const TreeState *state, int end,
                                             Vec2 beside)
{
    const int body = tree->end_bodies[end];
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Motion *motion = &state->motions[body];
    const Vec2 arm = vec2_add(state->arms[end], beside);
    return vec2_add(motion->velocity, vec2_scale(motion->omega, vec2_perp(arm)));
}

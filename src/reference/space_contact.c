// With which force does a pin in space press on a place of its hole?
//
// The model is that of contact/pin_space.h, its numbers are told apart from the base: with g the
// pin's point less the hole's, u the axis of the pin (of a collar: of the hole)
//     an end:    e = g - (u . g) u,   P = pin's point - (u . g) u
//     a collar:  e = (u . g) u,       P = the pin's middle
// and d = |e| - c. Friction acts at the wall's point nearest to the pin, on both bodies, against
// what slides there across the normal, along the wall and along the axis:
//     mu N tanh(|v| / v_s) v / |v|
// A collar has none.
//
// For the maxima of force and depth: with w the velocity of body b less that of body a at P, and
// s' the speed of P along the pin's axis, s' = -u . w - u' . e, u' = w_b x u,
//     d'' = (w . w + s' u . w - d'^2) / |e| + n . (a_b(P) - a_a(O)) + s' n . u',   n = e / |e|
// and of a collar  d'' = n . (a_b(M) - a_a(M)) + 2 (w_a x n) . w.
#include "reference/space_contact.h"

#include <math.h>

void space_contact_rebase(const SpaceTree *tree, SpaceContact *contact)
{
    const PinSpace *place = &contact->place;
    const SpaceEnd *hole = &place->hole;
    const SpaceEnd *pin = &place->pin;
    const LongVec3 hole_arm = space_tree_base_arm(tree, hole->body, hole->anchor);
    LongVec3 pin_arm = space_tree_base_arm(tree, pin->body, pin->anchor);
    const LongVec3 from = space_tree_base_point(tree, hole->body, hole->anchor);
    const LongVec3 to = space_tree_base_point(tree, pin->body, pin->anchor);
    LongVec3 gap = long_vec3_add(to, long_vec3_scale(-1.0L, from));
    const bool is_collar = place->place == PIN_SPACE_COLLAR;
    const SpaceEnd *along = is_collar ? hole : pin;
    const LongVec3 axis = space_tree_base_arm(tree, along->body, along->axis);
    if (!is_collar) {
        const long double share = long_vec3_dot(axis, gap) / long_vec3_dot(axis, axis);
        const LongVec3 back = long_vec3_scale(-share, axis);
        pin_arm = long_vec3_add(pin_arm, back);
        gap = long_vec3_add(gap, back);
    }
    contact->base_hole = long_vec3_round(hole_arm);
    contact->base_pin = long_vec3_round(pin_arm);
    contact->base_gap = long_vec3_round(gap);
    contact->base_axis = long_vec3_round(axis);
    contact->base_axis = vec3_scale(1.0 / vec3_length(contact->base_axis), contact->base_axis);
}

// Offset, axis and the points of both bodies at which the force acts.
static void find_pose(const SpaceContact *at, const SpaceTreeState *state, SpaceForce *force)
{
    const int a = at->place.hole.body;
    const int b = at->place.pin.body;
    const bool is_collar = at->place.place == PIN_SPACE_COLLAR;
    const SpaceBodyState *body_a = space_tree_body(state, a);
    const SpaceBodyState *body_b = space_tree_body(state, b);
    const Vec3 turned_a = mat3_apply(&body_a->turned, at->base_hole);
    const Vec3 turned_b = mat3_apply(&body_b->turned, at->base_pin);
    const Vec3 moved =
        vec3_sub(vec3_add(body_b->moved, turned_b), vec3_add(body_a->moved, turned_a));
    const Vec3 gap = vec3_add(at->base_gap, moved);
    force->axis = space_tree_direction(state, is_collar ? a : b, at->base_axis);
    const Vec3 along = vec3_scale(vec3_dot(force->axis, gap), force->axis);
    force->from_a = vec3_add(at->base_hole, turned_a);
    force->from_b = vec3_add(at->base_pin, turned_b);
    if (is_collar) {
        force->offset = along;
        force->from_a = vec3_add(force->from_a, gap);
    } else {
        force->offset = vec3_sub(gap, along);
        force->from_b = vec3_sub(force->from_b, along);
    }
    force->relative = vec3_sub(space_tree_velocity(state, b, force->from_b),
                               space_tree_velocity(state, a, force->from_a));
}

// Adds what friction does to an end that presses.
static void add_friction(const SpaceContact *at, const Contact *contact,
                         const SpaceTreeState *state, SpaceForce *force)
{
    const Vec3 wall = vec3_scale(contact->hole_radius, force->outward);
    force->force_a = vec3_add(force->from_a, wall);
    force->force_b = vec3_add(force->from_b, vec3_sub(wall, force->offset));
    const Vec3 sliding =
        vec3_across(vec3_sub(space_tree_velocity(state, at->place.pin.body, force->force_b),
                             space_tree_velocity(state, at->place.hole.body, force->force_a)),
                    force->outward);
    const double speed = vec3_length(sliding);
    const double scale = contact->law.friction_speed;
    // tanh(x) / x, which is 1 to the last bit below this speed
    const double share = speed > 1e-9 * scale ? tanh(speed / scale) / speed : 1.0 / scale;
    const double held = contact->law.friction * force->press.normal * share;
    force->force = vec3_sub(force->force, vec3_scale(held, sliding));
    force->press.friction_power = held * speed * speed;
}

void space_contact_find(const SpaceContact *at, const Contact *contact, const SpaceTreeState *state,
                        SpaceForce *force)
{
    find_pose(at, state, force);
    force->size = sqrt(vec3_dot(force->offset, force->offset));
    force->force = (Vec3){0.0, 0.0, 0.0};
    double closing = 0.0;
    if (force->size > 0.0) {
        force->outward = vec3_scale(1.0 / force->size, force->offset);
        closing = vec3_dot(force->outward, force->relative);
    } else {
        // a centred pin moves towards its wall, whichever way it goes
        force->outward = (Vec3){0.0, 0.0, 0.0};
        closing = contact->is_collar ? fabs(vec3_dot(force->axis, force->relative))
                                     : vec3_length(vec3_across(force->relative, force->axis));
    }
    force->press = press_find(contact, force->size - contact->clearance, closing);
    if (contact->mode != CONTACT_PRESSING) {
        return;
    }
    force->force = vec3_scale(-force->press.normal, force->outward);
    force->force_a = force->from_a;
    force->force_b = force->from_b;
    if (contact->law.friction > 0.0 && !contact->is_collar) {
        add_friction(at, contact, state, force);
    }
}

double space_contact_second(const SpaceContact *at, const SpaceTreeState *state,
                            const SpaceForce *force)
{
    const int a = at->place.hole.body;
    const int b = at->place.pin.body;
    const Vec3 outward = force->outward;
    const Vec3 w = force->relative;
    const Vec3 changing = vec3_sub(space_tree_acceleration(state, b, force->from_b),
                                   space_tree_acceleration(state, a, force->from_a));
    const double pushed = vec3_dot(outward, changing);
    if (at->place.place == PIN_SPACE_COLLAR) {
        const Vec3 turning = vec3_cross(space_tree_body(state, a)->omega, outward);
        return pushed + 2.0 * vec3_dot(turning, w);
    }
    const Vec3 swing = vec3_cross(space_tree_body(state, b)->omega, force->axis);
    const double sliding = vec3_dot(force->axis, w);
    const double along = -sliding - vec3_dot(swing, force->offset);
    const double closing = force->press.closing;
    return (vec3_dot(w, w) + along * sliding - closing * closing) / force->size + pushed +
           along * vec3_dot(outward, swing);
}

// With which force do two bodies press on one another where they touch?
//
// Where: contact/touch.h, with distances that keep their digits (reference/tree_line.h). Along the
// normal n as its law has it (reference/press.h), never below zero (that is the slack mode), and
// against the sliding speed v_t of the two bodies at the touching point, across the normal:
//     mu N tanh(v_t / v_s)
// tanh makes Coulomb's law smooth. The second rate of the gap of two circles, d from centre to
// centre, v its rate, + of discs and - of a pin in its hole:
//     n . d'' +- (v across n)^2 / |d|
#include "reference/dynamics_contact.h"

#include "kernel/pin_hole.h"
#include "model/coordinate.h"
#include "reference/tree_coordinate.h"
#include "reference/tree_line.h"

#include <math.h>

// Adds what friction does to a contact that presses.
static void add_friction(const Dynamics *dynamics, size_t number, const TreeState *state,
                         ContactForce *force)
{
    const ForceLaw *law = &dynamics->system.contacts[number].law;
    const int end = 2 * dynamics->places[number].pair;
    const Vec2 tangent = vec2_perp(force->pose.normal);
    Vec2 from_a;
    Vec2 from_b;
    dynamics_contact_points(&dynamics->places[number], &force->pose, &from_a, &from_b);
    const Vec2 sliding =
        vec2_sub(dynamics_contact_velocity(&dynamics->tree, state, end + 1, from_b),
                 dynamics_contact_velocity(&dynamics->tree, state, end, from_a));
    const double speed = vec2_dot(tangent, sliding);
    const double held = law->friction * force->press.normal * tanh(speed / law->friction_speed);
    force->force = vec2_sub(force->force, vec2_scale(held, tangent));
    force->press.friction_power = held * speed;
}

static TouchPose pose_in_hole(const Contact *contact, const Tree *tree, const TreeState *state,
                              int pair)
{
    const Vec2 velocity = tree_pair_velocity(tree, state, pair);
    const PinHole pin = pin_hole_pose((Vec2){0.0, 0.0}, tree_pair_gap(tree, state, pair), velocity,
                                      contact->clearance);
    return touch_pose_in_hole(&pin, velocity);
}

// A point or disc on body b against a line of body a, or a disc against a disc. The gap has the
// digits of the way since the base.
static TouchPose pose_outside(const Tree *tree, const TreeState *state, const PlanePlace *place)
{
    const int pair = place->pair;
    const bool is_line = place->touch.shape == TOUCH_LINE;
    const Vec2 line = is_line ? tree_normal(tree, state, pair) : (Vec2){0.0, 0.0};
    TouchPose pose = touch_pose_of(&place->touch, tree_pair_gap(tree, state, pair),
                                   tree_pair_velocity(tree, state, pair), line,
                                   tree_omega(state, tree->end_bodies[2 * pair]));
    pose.gap = tree_distance(tree, state, pair);
    return pose;
}

// An end of an angle, or a flank of teeth, which push at right angles to the line of the centres.
static TouchPose pose_of_end(const Tree *tree, const TreeState *state, const PlanePlace *place)
{
    const int joint = place->touch.joint;
    const double sign = place->touch.sign;
    const Vec2 offset = tree_pair_gap(tree, state, place->pair);
    TouchPose pose = {
        .offset = offset,
        .velocity = tree_pair_velocity(tree, state, place->pair),
        .gap = sign * tree_coordinate(tree, state, joint) - place->end,
        .has_normal = true,
        .approach_speed = -sign * tree_coordinate_rate(tree, state, joint),
    };
    if (place->touch.shape == TOUCH_TEETH) {
        pose.normal = vec2_scale(sign / sqrt(vec2_dot(offset, offset)), vec2_perp(offset));
    }
    return pose;
}

static TouchPose pose_of(const Contact *contact, const Tree *tree, const TreeState *state,
                         const PlanePlace *place)
{
    if (place->touch.shape == TOUCH_HOLE) {
        return pose_in_hole(contact, tree, state, place->pair);
    }
    return dynamics_contact_is_turn(place) ? pose_of_end(tree, state, place)
                                           : pose_outside(tree, state, place);
}

double dynamics_contact_second(const Dynamics *dynamics, size_t number, const TreeState *state,
                               const TouchPose *pose)
{
    const PlanePlace *place = &dynamics->places[number];
    if (place->touch.shape == TOUCH_LINE) {
        return tree_line_second(&dynamics->tree, state, place->pair);
    }
    if (dynamics_contact_is_turn(place)) {
        return place->touch.sign *
               tree_coordinate_second(&dynamics->tree, state, place->touch.joint);
    }
    const double across = vec2_cross(pose->normal, pose->velocity);
    const double turning = across * across / sqrt(vec2_dot(pose->offset, pose->offset));
    return vec2_dot(pose->normal, tree_pair_acceleration(&dynamics->tree, state, place->pair)) +
           (place->touch.shape == TOUCH_HOLE ? -turning : turning);
}

void dynamics_contact_find(const Dynamics *dynamics, size_t number, const TreeState *state,
                           ContactForce *force)
{
    const Contact *contact = &dynamics->system.contacts[number];
    const PlanePlace *place = &dynamics->places[number];
    force->pose = pose_of(contact, &dynamics->tree, state, place);
    force->press = press_find(contact, -force->pose.gap, force->pose.approach_speed);
    force->force = (Vec2){0.0, 0.0};
    force->couple = 0.0;
    if (contact->mode != CONTACT_PRESSING) {
        return;
    }
    force->force = vec2_scale(force->press.normal, force->pose.normal);
    if (place->touch.shape == TOUCH_TURN) {
        const Joint *joint = &dynamics->tree.linkage->joints[contact->joint];
        force->couple = place->touch.sign * coordinate_sense(joint) * force->press.normal;
    }
    if (contact->law.friction > 0.0 && !dynamics_contact_is_turn(place)) {
        add_friction(dynamics, number, state, force);
    }
}

// With which force do pin and hole press on one another?
//
// Along the normal as its law has it (reference/press.h), never below zero (that is the slack
// mode), and against the sliding speed v_t of the two bodies at the wall's nearest point, along the
// wall:
//     mu N tanh(v_t / v_s)
// tanh makes Coulomb's law smooth.
#include "reference/dynamics_contact.h"

#include <math.h>

Vec2 dynamics_contact_velocity(const Tree *tree, const TreeState *state, int end, Vec2 beside)
{
    const int body = tree->end_bodies[end];
    const Vec2 velocity = tree_end_velocity(tree, state, end);
    return body == LINKAGE_GROUND
               ? velocity
               : vec2_add(velocity, vec2_scale(state->motions[body].omega, vec2_perp(beside)));
}

void dynamics_contact_points(const Contact *contact, const ContactOptions *options,
                             const PinHole *pose, Vec2 *from_hole, Vec2 *from_pin)
{
    *from_hole = *from_pin = (Vec2){0.0, 0.0};
    if (options->friction > 0.0) {
        *from_hole = vec2_scale(-contact->hole_radius, pose->normal);
        *from_pin = vec2_sub(*from_hole, pose->eccentricity);
    }
}

// Adds what friction does to a contact that presses.
static void add_friction(const Contact *contact, const ContactOptions *options, const Tree *tree,
                         const TreeState *state, ContactForce *force)
{
    const int hole = 2 * contact->joint;
    const Vec2 tangent = vec2_perp(force->pose.normal);
    Vec2 from_hole;
    Vec2 from_pin;
    dynamics_contact_points(contact, options, &force->pose, &from_hole, &from_pin);
    const Vec2 sliding = vec2_sub(dynamics_contact_velocity(tree, state, hole + 1, from_pin),
                                  dynamics_contact_velocity(tree, state, hole, from_hole));
    const double speed = vec2_dot(tangent, sliding);
    const double held =
        options->friction * force->press.normal * tanh(speed / options->friction_speed);
    force->force = vec2_sub(force->force, vec2_scale(held, tangent));
    force->press.friction_power = held * speed;
}

void dynamics_contact_find(const Contact *contact, const ContactOptions *options, const Tree *tree,
                           const TreeState *state, ContactForce *force)
{
    const Vec2 gap = tree_joint_gap(tree, state, contact->joint);
    const Vec2 moving = tree_joint_velocity(tree, state, contact->joint);
    force->pose = pin_hole_pose((Vec2){0.0, 0.0}, gap, moving, contact->clearance);
    force->press = press_find(contact, force->pose.penetration, force->pose.approach_speed);
    force->force = (Vec2){0.0, 0.0};
    if (contact->mode != CONTACT_PRESSING) {
        return;
    }
    force->force = vec2_scale(force->press.normal, force->pose.normal);
    if (options->friction > 0.0) {
        add_friction(contact, options, tree, state, force);
    }
}

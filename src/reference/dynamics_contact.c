// With which force do pin and hole press on one another?
//
// From the law, along the normal, never below zero (that is the slack mode):
//     N = F_el(d) (1 + chi d'/v0) + c d'
// and against the sliding speed v_t of the two bodies at the wall's nearest point, along the wall:
//     mu N tanh(v_t / v_s)
// tanh makes Coulomb's law smooth.
#include "reference/dynamics_contact.h"

#include "contact/law.h"

static PinHole contact_pose(const Dynamics *dynamics, size_t number, const TreeState *tree)
{
    const DynamicsContact *contact = &dynamics->contacts[number];
    const Vec2 gap = tree_joint_gap(&dynamics->tree, tree, contact->joint);
    const Vec2 moving = tree_joint_velocity(&dynamics->tree, tree, contact->joint);
    return pin_hole_pose((Vec2){0.0, 0.0}, gap, moving, contact->radial_clearance);
}

Vec2 dynamics_contact_velocity(const Tree *tree, const TreeState *state, int end, Vec2 beside)
{
    const int body = tree->end_bodies[end];
    const Vec2 velocity = tree_end_velocity(tree, state, end);
    return body == LINKAGE_GROUND
               ? velocity
               : vec2_add(velocity, vec2_scale(state->motions[body].omega, vec2_perp(beside)));
}

void dynamics_contact_places(const Dynamics *dynamics, const DynamicsContact *contact,
                             const PinHole *pose, Vec2 *from_hole, Vec2 *from_pin)
{
    *from_hole = *from_pin = (Vec2){0.0, 0.0};
    if (dynamics->scenario->contact.friction > 0.0) {
        *from_hole = vec2_scale(-contact->hole_radius, pose->normal);
        *from_pin = vec2_sub(*from_hole, pose->eccentricity);
    }
}

// Adds what friction does to a contact that presses.
static void add_friction(const Dynamics *dynamics, const DynamicsContact *contact,
                         const TreeState *tree, ContactForce *force)
{
    const ContactOptions *options = &dynamics->scenario->contact;
    const int hole = 2 * contact->joint;
    const Vec2 tangent = vec2_perp(force->pose.normal);
    Vec2 from_hole;
    Vec2 from_pin;
    dynamics_contact_places(dynamics, contact, &force->pose, &from_hole, &from_pin);
    const Vec2 sliding =
        vec2_sub(dynamics_contact_velocity(&dynamics->tree, tree, hole + 1, from_pin),
                 dynamics_contact_velocity(&dynamics->tree, tree, hole, from_hole));
    const double speed = vec2_dot(tangent, sliding);
    const double held = options->friction * force->normal * tanh(speed / options->friction_speed);
    force->force = vec2_sub(force->force, vec2_scale(held, tangent));
    force->friction_power = held * speed;
}

void dynamics_contact_find(const Dynamics *dynamics, size_t number, const TreeState *tree,
                           ContactForce *force)
{
    const DynamicsContact *contact = &dynamics->contacts[number];
    const ForceLaw *law = &contact->law;
    *force = (ContactForce){.pose = contact_pose(dynamics, number, tree)};
    if (contact->mode == CONTACT_APART) {
        return;
    }
    // odd below zero depth: a step that overshoots the end of a contact stays smooth
    const double depth = force->pose.penetration;
    const double closing = force->pose.approach_speed;
    force->elastic = copysign(force_law_elastic(law, fabs(depth)), depth);
    const double rise = 1.0 + contact->damping_rate * closing;
    force->pressing = force->elastic * rise + law->viscous * closing;
    force->release = law->viscous > 0.0 ? force->pressing : rise;
    // a slack spring relaxes by itself: what it had stored is lost like the damper's work
    force->normal = contact->mode == CONTACT_PRESSING ? force->pressing : 0.0;
    force->damping_power = (force->normal - force->elastic) * closing;
    if (contact->mode == CONTACT_SLACK) {
        return;
    }
    force->force = vec2_scale(force->normal, force->pose.normal);
    if (dynamics->scenario->contact.friction > 0.0) {
        add_friction(dynamics, contact, tree, force);
    }
}

ContactForce dynamics_contact(const Dynamics *dynamics, size_t contact, double since_s,
                              const double *y)
{
    TreeState tree;
    tree_evaluate(&dynamics->tree, since_s, y, y + dynamics->tree.coordinate_count, &tree);
    ContactForce force;
    dynamics_contact_find(dynamics, contact, &tree, &force);
    return force;
}

bool dynamics_check_depth(const Dynamics *dynamics, const DynamicsState *state, double share,
                          Err *err)
{
    for (size_t i = 0; i < dynamics->contact_count; i++) {
        const DynamicsContact *contact = &dynamics->contacts[i];
        const Joint *joint = &dynamics->scenario->linkage.joints[contact->joint];
        if (!law_check_depth(&contact->law, joint, state->contacts[i].pose.penetration, share,
                             err)) {
            return false;
        }
    }
    return true;
}

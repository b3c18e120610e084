// With which torque do flanks or stops press on a hinge in space?
//
// The angle counts from the base, where it has the digits of a long double: with u the axis on body
// a, s_a and s_b a direction across it that both bodies carry and that is one at the base,
//     q = q_base +- atan2(u . (s_a x (s_b - s_a)), s_a . s_b),   q' = +- u . (w_b - w_a)
// and a penetration of s (q_end - q), s = 1 at the low end and -1 at the high one, is pressed back
// by a torque s N along q on body b and the other way on body a.
#include "contact/law.h"
#include "model/space_coordinate.h"
#include "reference/space_contact.h"

static Vec3 axis_of(const SpaceTree *tree, const SpaceTreeState *state, int joint)
{
    return vec3_scale(coordinate_sense(&tree->linkage->joints[joint]),
                      space_tree_axis(tree, state, 2 * joint));
}

double space_turn_angle(const SpaceTree *tree, const SpaceTreeState *state, int joint)
{
    const Vec3 side = vec3_normal_to(tree->base_axes[2 * joint]);
    const Vec3 a = mat3_apply(&space_tree_body(state, tree->ends[2 * joint].body)->turned, side);
    const Vec3 b =
        mat3_apply(&space_tree_body(state, tree->ends[2 * joint + 1].body)->turned, side);
    const Vec3 at_a = vec3_add(side, a);
    const double sine = vec3_dot(axis_of(tree, state, joint), vec3_cross(at_a, vec3_sub(b, a)));
    return tree->base_coordinates[joint] + atan2(sine, vec3_dot(at_a, vec3_add(side, b)));
}

double space_turn_rate(const SpaceTree *tree, const SpaceTreeState *state, int joint)
{
    const SpaceBodyState *a = space_tree_body(state, tree->ends[2 * joint].body);
    const SpaceBodyState *b = space_tree_body(state, tree->ends[2 * joint + 1].body);
    return vec3_dot(axis_of(tree, state, joint), vec3_sub(b->omega, a->omega));
}

double space_turn_second(const SpaceTree *tree, const SpaceTreeState *state, int joint)
{
    const SpaceBodyState *a = space_tree_body(state, tree->ends[2 * joint].body);
    const SpaceBodyState *b = space_tree_body(state, tree->ends[2 * joint + 1].body);
    // what the axis turns by is across it, and so is nothing of the bodies' turning about it
    return vec3_dot(axis_of(tree, state, joint), vec3_sub(b->alpha, a->alpha));
}

void space_turn_find(const SpaceContact *at, const Contact *contact, const SpaceTree *tree,
                     const SpaceTreeState *state, SpaceForce *force)
{
    const int joint = at->place.joint;
    const Vec3 none = {0.0, 0.0, 0.0};
    force->force = force->couple = none;
    force->press =
        press_find(contact, at->sign * (at->limit - space_turn_angle(tree, state, joint)),
                   -at->sign * space_turn_rate(tree, state, joint));
    if (contact->mode == CONTACT_PRESSING) {
        force->couple = vec3_scale(at->sign * force->press.normal, axis_of(tree, state, joint));
    }
}

// m: the lever of the angle, the shorter of how far its bodies reach.
static double arm_of(const SpaceTree *tree, int joint)
{
    double arm = INFINITY;
    for (int side = 0; side < 2; side++) {
        const int body = tree->ends[2 * joint + side].body;
        arm = body == LINKAGE_GROUND ? arm : fmin(arm, tree->reaches[body]);
    }
    return arm;
}

size_t space_turn_list(const Scenario *scenario, const SpaceTree *tree, int joint,
                       SpaceContact *contacts, Contact *laws, Err *err)
{
    const Joint *of = &scenario->linkage.joints[joint];
    const double ends[2] = {coordinate_low(of), coordinate_high(of)};
    ForceLaw law;
    if (!law_of_joint(scenario, of, &law, err)) {
        return 0;
    }
    size_t count = 0;
    for (int i = 0; i < 2; i++) {
        if (isfinite(ends[i])) {
            contacts[count] = (SpaceContact){
                .place = {.joint = joint,
                          .hole = {.body = of->body_a},
                          .pin = {.body = of->body_b}},
                .is_turn = true,
                .sign = i == 0 ? 1.0 : -1.0,
                .limit = ends[i],
            };
            const double play = coordinate_play(of);
            laws[count++] = (Contact){
                .joint = joint,
                .law = law,
                .arm = arm_of(tree, joint),
                .flight = isfinite(play) ? play : 1.0,
            };
        }
    }
    if (count == 2) {
        laws[0].partner = 1;
        laws[1].partner = -1;
    }
    return count;
}

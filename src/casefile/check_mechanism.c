// Is this a mechanism at all?
#include "casefile/check_mechanism.h"

#include <math.h>

static bool has_joint(const Linkage *linkage, int body)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].body_a == body || linkage->joints[i].body_b == body) {
            return true;
        }
    }
    return false;
}

static bool check_bodies(const Entries *entries, const Linkage *linkage, Err *err)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (!has_joint(linkage, (int)i)) {
            const EntryGroup *group = entries_group(entries, "bodies.*", i);
            return entries_refuse_group(group, err,
                                        "the body '%s' has no joint: nothing holds it\nallowed: a "
                                        "joint between it and the ground or another body",
                                        linkage->bodies[i].name);
        }
    }
    return true;
}

static bool share_a_body(const Joint *joint, const Joint *other)
{
    return (joint->body_a != LINKAGE_GROUND &&
            (joint->body_a == other->body_a || joint->body_a == other->body_b)) ||
           (joint->body_b != LINKAGE_GROUND &&
            (joint->body_b == other->body_a || joint->body_b == other->body_b));
}

// The least distance from a joint to the next on one of its bodies, m; infinite without a next.
// Joints at one place are one hinge of several bodies.
static double shortest_link(const Entries *entries, const Scenario *scenario, size_t number)
{
    const FourBar *fourbar = &scenario->fourbar;
    const Linkage *linkage = &scenario->linkage;
    if (entries->form == SCHEMA_SHORT) {
        const double links[] = {fourbar->ground.nominal, fourbar->crank.nominal,
                                fourbar->coupler.nominal, fourbar->follower.nominal};
        return fmin(links[number], links[(number + 1) % 4]);
    }
    double shortest = INFINITY;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        // in a case with bodies every joint still stands at its place in the world
        const double distance =
            vec2_length(vec2_sub(linkage->joints[i].anchor_a, linkage->joints[number].anchor_a));
        if (distance > 0.0 && share_a_body(&linkage->joints[number], &linkage->joints[i])) {
            shortest = fmin(shortest, distance);
        }
    }
    return shortest;
}

static bool check_play(const Entries *entries, const Scenario *scenario, size_t number, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[number];
    const double shortest = shortest_link(entries, scenario, number);
    const double radial = linkage_radial_clearance(joint);
    if (joint->kind != JOINT_CLEARANCE || radial < shortest) {
        return true;
    }
    return entries_refuse(
        entries_blame(entries, "joints.*.radial-clearance joints.*.hole joints.*.pin", number), err,
        "the radial clearance of joint '%s' (%.6g mm) is as long as a link\n"
        "allowed: a radial clearance far below %.6g mm, the next joint's "
        "distance; usual are 5 to 500 um",
        joint->name, 1e3 * radial, 1e3 * shortest);
}

bool check_mechanism(const Entries *entries, const Scenario *scenario, Err *err)
{
    // the links of a four-bar are joined by definition
    if (entries->form == SCHEMA_LONG && !check_bodies(entries, &scenario->linkage, err)) {
        return false;
    }
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (!check_play(entries, scenario, i, err)) {
            return false;
        }
    }
    return true;
}

// Tells which linkages in space never leave the plane, and makes planar ones of them.
#include "model/space_flat.h"

#include "base/drive.h"
#include "base/union_find.h"
#include "base/zeroed.h"
#include "model/forces.h"
#include "model/space.h"

#include <math.h>
#include <stdlib.h>

// Whether all that acts and all that turns lies in the plane.
static bool acts_in_plane(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    // what is for the plane alone has its own rules there
    const bool has_more = forces_any(linkage) || linkage->further_count > 0;
    const bool is_steady = !linkage->driver.is_present || drive_is_steady(&linkage->driver);
    return scenario->gravity.z == 0.0 && space_is_upright(linkage) && is_steady && !has_more;
}

// Writes which bodies hang by hinges on the ground or on the driven body: by number. Returns false
// where ideal joints close a loop: their rows may be redundant in the plane, and in space are
// chosen.
static bool find_held(const Linkage *linkage, bool *is_held)
{
    const size_t ground = linkage->body_count;
    size_t *sets = zeroed(linkage->body_count + 1, sizeof *sets);
    bool is_tree = true;
    union_find_start(sets, linkage->body_count + 1);
    if (linkage->driver.is_present) {
        union_find_join(sets, ground, (size_t)linkage_driven_body(linkage));
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const size_t a = joint->body_a == LINKAGE_GROUND ? ground : (size_t)joint->body_a;
        const size_t b = joint->body_b == LINKAGE_GROUND ? ground : (size_t)joint->body_b;
        if (linkage_is_ideal(linkage, i)) {
            is_tree = is_tree && union_find_root(sets, a) != union_find_root(sets, b);
            union_find_join(sets, a, b);
        }
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        is_held[i] = union_find_root(sets, i) == union_find_root(sets, ground);
    }
    free(sets);
    return is_tree;
}

// Whether a body that nothing holds is its own mirror image, and starts so.
static bool is_even(const Body *body)
{
    const BodySpace *space = &body->space;
    const bool is_placed = !space->is_elsewhere || (space->position.z == space->height &&
                                                    space->turn.x == 0.0 && space->turn.y == 0.0);
    return space->product_xz == 0.0 && space->product_yz == 0.0 && space->velocity_z == 0.0 &&
           space->omega_x == 0.0 && space->omega_y == 0.0 && is_placed;
}

static bool are_same(const ContactState *a, const ContactState *b)
{
    return a->is_touching == b->is_touching && a->is_slack == b->is_slack &&
           a->is_released == b->is_released && a->is_resting == b->is_resting &&
           a->impact_speed == b->impact_speed && a->damping_speed == b->damping_speed &&
           a->age_s == b->age_s;
}

// Whether a joint touches alike on both sides of the plane.
static bool is_even_joint(const Linkage *linkage, const Joint *joint, const bool *is_held)
{
    const int bodies[2] = {joint->body_a, joint->body_b};
    for (int side = 0; side < 2; side++) {
        const int body = bodies[side];
        if (body != LINKAGE_GROUND && !is_held[body] &&
            linkage->bodies[body].space.height != joint->space.height) {
            return false;
        }
    }
    // the two ends of a pin, and a collar; those of an angle have turns to count
    return !joint_has_hole(joint->kind) ||
           (are_same(&joint->contacts[0], &joint->contacts[1]) && !joint->contacts[2].is_touching);
}

// Whether a body that is held and starts elsewhere is turned about z alone, but for rounding.
static bool is_turned_in_plane(const BodySpace *space)
{
    const double rounding = 1e-12;
    return !space->is_elsewhere ||
           (fabs(space->turn.x) <= rounding && fabs(space->turn.y) <= rounding);
}

bool space_flat_is(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    if (!linkage->is_spatial || !acts_in_plane(scenario)) {
        return false;
    }
    const bool is_elsewhere = space_starts_elsewhere(linkage);
    bool *is_held = zeroed(linkage->body_count, sizeof *is_held);
    bool is_flat = find_held(linkage, is_held);
    for (size_t i = 0; i < linkage->body_count && is_flat; i++) {
        const Body *body = &linkage->bodies[i];
        is_flat = is_held[i] ? is_turned_in_plane(&body->space) : is_even(body);
    }
    for (size_t i = 0; i < linkage->joint_count && is_flat; i++) {
        const Joint *joint = &linkage->joints[i];
        is_flat = is_even_joint(linkage, joint, is_held) &&
                  !(is_elsewhere && joint->limits.kind != LIMIT_NONE);
    }
    free(is_held);
    return is_flat;
}

Scenario space_flat_scenario(const Scenario *scenario)
{
    Scenario flat = scenario_around(scenario, linkage_copy(&scenario->linkage));
    flat.space = SCENARIO_PLANAR;
    flat.linkage.is_spatial = false;
    for (size_t i = 0; i < flat.linkage.body_count; i++) {
        Body *body = &flat.linkage.bodies[i];
        // the drive says where its body is
        if (body->space.is_elsewhere && !linkage_is_driven(&flat.linkage, (int)i)) {
            body->start.position = (Vec2){body->space.position.x, body->space.position.y};
            body->start.angle = 2.0 * atan2(body->space.turn.z, body->space.turn.w);
        }
    }
    return flat;
}

static Vec3 lifted(Vec2 a, double z)
{
    return (Vec3){a.x, a.y, z};
}

SpaceMotion space_flat_motion(const Body *body, const Motion *planar)
{
    return (SpaceMotion){
        .position = lifted(planar->position, body->space.height),
        .turn = {cos(0.5 * planar->angle), 0.0, 0.0, sin(0.5 * planar->angle)},
        .velocity = lifted(planar->velocity, 0.0),
        .omega = {0.0, 0.0, planar->omega},
        .acceleration = lifted(planar->acceleration, 0.0),
        .alpha = {0.0, 0.0, planar->alpha},
    };
}

SpaceJointState space_flat_joint(const Joint *joint, const JointState *planar)
{
    SpaceJointState state = {
        .force_on_b = lifted(planar->force_on_b, 0.0),
        .offset = lifted(planar->eccentricity, 0.0),
    };
    for (int end = 0; end < 2 && joint_has_hole(joint->kind); end++) {
        state.ends[end] = state.offset;
        state.end_gaps[end] = planar->gap;
        state.end_forces[end] = 0.5 * planar->force;
    }
    return state;
}

// How does a mechanism of hinges and pins in holes stand at one instant?
//
// As reference/hinged.c finds its rates, with what rates do not need: angles and positions, pins
// that are apart, and the forces of all hinges.
#include "reference/hinged_state.h"

#include "kernel/pin_hole.h"

static inline void hold(const HingedBody *body, const HingedBody *driven, HingedLoad *load,
                        Vec2 held)
{
    HingedBody *parent = body->parent;
    const Vec2 force = vec2_scale(-1.0, held);
    if (parent == NULL) {
        return;
    }
    if (parent == driven) {
        const Vec2 turning = vec2_scale(driven->omega, vec2_perp(body->outer));
        hinged_load_driven(force, vec2_add(driven->velocity, turning), load);
    } else {
        parent->force = vec2_add(parent->force, force);
    }
}

void hinged_hold(const Hinged *hinged, const double *rates, HingedLoad *load, Vec2 *reactions)
{
    HingedBody *driven = hinged->driven;
    const TreeNode *nodes = hinged->dynamics->tree.nodes;
    if (driven != NULL) {
        driven->acceleration = driven->bias; // at a steady speed
    }
    for (size_t i = 0; i < hinged->count; i++) {
        hinged_accelerate(rates, &hinged->bodies[i]);
    }
    for (size_t i = hinged->count; i-- > 0;) {
        const HingedBody *body = &hinged->bodies[i];
        if (body->is_floating) {
            continue;
        }
        const Vec2 held = vec2_sub(vec2_scale(body->mass, body->acceleration), body->force);
        if (reactions != NULL) {
            reactions[nodes[i].joint] = nodes[i].own_end % 2 == 1 ? held : vec2_scale(-1.0, held);
        }
        hold(body, driven, load, held);
    }
}

// Shows where a body has moved, and how fast it does.
static inline void place(const Tree *tree, int number, const HingedBody *body, double turned,
                         Motion *motions)
{
    const Motion *base = &tree->base_motions[number];
    Motion *motion = &motions[number];
    motion->position = vec2_add(base->position, body->moved);
    motion->angle = base->angle + turned;
    motion->velocity = body->velocity;
    motion->omega = body->omega;
}

static inline void place_all(const Hinged *hinged, double since_s, const double *q, Motion *motions)
{
    const Tree *tree = &hinged->dynamics->tree;
    if (hinged->driven != NULL) {
        place(tree, tree->driven, hinged->driven, hinged->driven->omega * since_s, motions);
    }
    for (size_t i = 0; i < hinged->count; i++) {
        const TreeNode *node = &tree->nodes[i];
        place(tree, node->body, &hinged->bodies[i], q[node->column], motions);
    }
}

void hinged_place(const Hinged *hinged, double since_s, const double *y, Motion *motions)
{
    hinged_move(hinged, since_s, y, y + hinged->dynamics->tree.coordinate_count);
    place_all(hinged, since_s, y, motions);
}

static inline void show_acceleration(const HingedBody *body, Motion *motion)
{
    motion->acceleration = body->acceleration;
    motion->alpha = body->spin;
}

// Shows accelerations, and the arms of hinges.
static inline void show_all(const Hinged *hinged, TreeState *state)
{
    const Tree *tree = &hinged->dynamics->tree;
    if (hinged->driven != NULL) {
        state->arms[2 * tree->linkage->driver.joint + 1] = hinged->driven->arm;
        show_acceleration(hinged->driven, &state->motions[tree->driven]);
    }
    for (size_t i = 0; i < hinged->count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const HingedBody *body = &hinged->bodies[i];
        show_acceleration(body, &state->motions[node->body]);
        if (body->is_floating) {
            continue;
        }
        state->arms[node->own_end] = body->arm;
        if (body->parent != NULL) {
            state->arms[node->parent_end] = body->outer;
        }
    }
}

// Where a pin is and how it presses, with the force of that in the loads.
static inline void look_at(HingedPin *pin, int pair, DynamicsState *state, ContactForce *at,
                           HingedLoad *load)
{
    const Contact *contact = pin->contact;
    Vec2 velocity_a;
    Vec2 velocity_b;
    const Vec2 moved_b = hinged_move_end(&pin->ends[1], &velocity_b);
    const Vec2 moved_a = hinged_move_end(&pin->ends[0], &velocity_a);
    const Vec2 gap = vec2_add(*pin->gap, vec2_sub(moved_b, moved_a));
    const Vec2 velocity = vec2_sub(velocity_b, velocity_a);
    const PinHole pose = pin_hole_pose((Vec2){0.0, 0.0}, gap, velocity, contact->clearance);
    state->tree.arms[2 * pair] = pin->ends[0].arm;
    state->tree.arms[2 * pair + 1] = pin->ends[1].arm;
    at->pose = touch_pose_in_hole(&pose, velocity);
    at->press = press_find(contact, -pose.gap, pose.approach_speed);
    at->force = (Vec2){0.0, 0.0};
    at->couple = 0.0;
    if (contact->mode == CONTACT_PRESSING) {
        at->force = vec2_scale(at->press.normal, pose.normal);
        hinged_load_end(&pin->ends[1], velocity_b, at->force, load);
        hinged_load_end(&pin->ends[0], velocity_a, vec2_scale(-1.0, at->force), load);
    }
}

static void fill_rates(const Hinged *hinged, const DynamicsState *state, const double *y,
                       double *rates)
{
    const Dynamics *dynamics = hinged->dynamics;
    const size_t n = dynamics->tree.coordinate_count;
    double *sums = rates + 2 * n;
    for (size_t i = 0; i < n; i++) {
        rates[i] = y[n + i];
        rates[n + i] = dynamics->room.solved[i];
    }
    sums[SYSTEM_DRIVE_WORK] = state->drive_power;
    sums[SYSTEM_DISSIPATED] = 0.0;
    sums[SYSTEM_FRICTION] = 0.0;
    for (size_t i = 0; i < hinged->pin_count; i++) {
        const Vec2 force = state->contacts[i].force;
        sums[SYSTEM_DISSIPATED] += state->contacts[i].press.damping_power;
        sums[SYSTEM_IMPULSES + i] = sqrt(vec2_dot(force, force));
    }
}

bool hinged_evaluate(const Hinged *hinged, double since_s, const double *y, DynamicsState *state,
                     double *rates)
{
    const Dynamics *dynamics = hinged->dynamics;
    const Tree *tree = &dynamics->tree;
    double *solved = dynamics->room.solved;
    HingedLoad load = {.power = 0.0};
    hinged_move(hinged, since_s, y, y + tree->coordinate_count);
    for (size_t i = 0; i < hinged->pin_count; i++) {
        look_at(&hinged->pins[i], dynamics->places[i].pair, state, &state->contacts[i], &load);
        state->shared.contacts[i] = state->contacts[i].press;
    }
    if (!hinged_bodies_solve(hinged->bodies, hinged->count, solved)) {
        return false;
    }
    hinged_hold(hinged, solved, &load, state->reactions);
    place_all(hinged, since_s, y, state->tree.motions);
    show_all(hinged, &state->tree);
    state->drive_power = 0.0;
    state->damping_power = 0.0;
    if (hinged->driven != NULL) {
        const Vec2 needed = hinged_needed(hinged);
        state->drive_power = vec2_dot(needed, hinged->driven->velocity) - load.power;
        state->reactions[tree->linkage->driver.joint] = vec2_sub(needed, load.force);
    }
    if (rates != NULL) {
        fill_rates(hinged, state, y, rates);
    }
    return true;
}

// Finds the rates of a mechanism of hinges and pins in holes.
//
// Outwards: where bodies have moved and how fast (reference/plane/tree.c). Pins that are not apart
// press. Inwards: bodies are eliminated, and outwards again: their second rates. Then the drive's
// power, which needs the forces of the hinges on the driven body. The equations are those of
// reference/plane/dynamics.c and reference/plane/articulated.c.
#include "reference/plane/hinged.h"

#include "kernel/pin_hole.h"
#include "reference/plane/dynamics.h"

#include <assert.h>
#include <stdlib.h>

// The drive's speed is steady.
static inline void hinged_move_driven(double omega, double since_s, HingedBody *body)
{
    body->turn = turned_by(omega * since_s);
    body->omega = omega;
    const Vec2 base = *body->own_base;
    const Vec2 turned = turned_arm(&body->turn, base);
    const Vec2 arm = vec2_add(base, turned);
    body->arm = arm;
    body->moved = vec2_scale(-1.0, turned);
    body->velocity = vec2_scale(-omega, vec2_perp(arm));
    body->bias = vec2_scale(omega * omega, arm);
}

static inline void hinged_move_floating(HingedBody *body, const double *q, const double *u)
{
    const size_t column = body->column;
    body->turn = turned_by(q[column]);
    body->omega = u[column];
    body->arm = (Vec2){0.0, 0.0};
    body->moved = (Vec2){q[column - 2], q[column - 1]};
    body->velocity = (Vec2){u[column - 2], u[column - 1]};
    body->bias = (Vec2){0.0, 0.0};
}

static inline void hinged_move_hinged(HingedBody *body, const double *q, const double *u)
{
    const double omega = u[body->column];
    const TurnedBy turn = turned_by(q[body->column]);
    const Vec2 base = *body->own_base;
    const Vec2 turned = turned_arm(&turn, base);
    const Vec2 arm = vec2_add(base, turned);
    Vec2 moved = vec2_scale(-1.0, turned);
    Vec2 velocity = vec2_scale(-omega, vec2_perp(arm));
    Vec2 bias = vec2_scale(omega * omega, arm);
    const HingedBody *parent = body->parent;
    if (parent != NULL) {
        const double spun = parent->omega;
        const Vec2 outer_base = *body->outer_base;
        const Vec2 outer_turned = turned_arm(&parent->turn, outer_base);
        const Vec2 outer = vec2_add(outer_base, outer_turned);
        moved = vec2_add(moved, vec2_add(parent->moved, outer_turned));
        velocity =
            vec2_add(velocity, vec2_add(parent->velocity, vec2_scale(spun, vec2_perp(outer))));
        bias = vec2_add(bias, vec2_sub(parent->bias, vec2_scale(spun * spun, outer)));
        body->outer = outer;
    }
    body->turn = turn;
    body->omega = omega;
    body->arm = arm;
    body->moved = moved;
    body->velocity = velocity;
    body->bias = bias;
}

// How far an end has moved since the base, and how fast it does.
static inline Vec2 hinged_move_end(HingedEnd *end, Vec2 *velocity)
{
    const HingedBody *body = end->body;
    if (body == NULL) {
        *velocity = (Vec2){0.0, 0.0};
        return (Vec2){0.0, 0.0};
    }
    const Vec2 base = *end->base;
    const Vec2 turned = turned_arm(&body->turn, base);
    const Vec2 arm = vec2_add(base, turned);
    end->arm = arm;
    *velocity = vec2_add(body->velocity, vec2_scale(body->omega, vec2_perp(arm)));
    return vec2_add(body->moved, turned);
}

// Power, W, and force, N, of what acts on the driven body beside the drive.
typedef struct HingedLoad {
    double power;
    Vec2 force;
} HingedLoad;

static inline void hinged_load_driven(Vec2 force, Vec2 velocity, HingedLoad *driven)
{
    driven->power += vec2_dot(force, velocity);
    driven->force = vec2_add(driven->force, force);
}

static inline void hinged_load_end(const HingedEnd *end, Vec2 velocity, Vec2 force,
                                   HingedLoad *driven)
{
    HingedBody *body = end->body;
    if (end->is_driven) {
        hinged_load_driven(force, velocity, driven);
    } else if (body != NULL) {
        body->force = vec2_add(body->force, force);
        body->moment += vec2_cross(end->arm, force);
    }
}

// The acceleration of a body's centre.
static inline void hinged_accelerate(const double *rates, HingedBody *body)
{
    const double *own = rates + body->column;
    body->spin = own[0];
    if (body->is_floating) {
        body->acceleration = (Vec2){own[-2], own[-1]};
        return;
    }
    Vec2 carried = {0.0, 0.0};
    const HingedBody *parent = body->parent;
    if (parent != NULL) {
        const Vec2 turned = vec2_sub(vec2_scale(parent->spin, vec2_perp(body->outer)),
                                     vec2_scale(parent->omega * parent->omega, body->outer));
        carried = vec2_add(parent->acceleration, turned);
    }
    const Vec2 about = vec2_sub(vec2_scale(body->omega * body->omega, body->arm),
                                vec2_scale(body->spin, vec2_perp(body->arm)));
    body->acceleration = vec2_add(carried, about);
}

// What the driven body needs of all forces on it, N.
static inline Vec2 hinged_needed(const Hinged *hinged)
{
    const HingedBody *driven = hinged->driven;
    const Vec2 upward = scenario_upward(hinged->dynamics->system.scenario);
    return vec2_scale(driven->mass, vec2_add(driven->bias, upward));
}

static inline void hinged_move(const Hinged *hinged, double since_s, const double *q,
                               const double *u)
{
    if (hinged->driven != NULL) {
        hinged_move_driven(hinged->dynamics->tree.drives[0].base.terms[0], since_s, hinged->driven);
    }
    for (size_t i = 0; i < hinged->count; i++) {
        HingedBody *body = &hinged->bodies[i];
        if (body->is_floating) {
            hinged_move_floating(body, q, u);
        } else {
            hinged_move_hinged(body, q, u);
        }
        body->force = body->weight;
        body->moment = 0.0;
    }
}

// The elimination of a tree of hinges and floating bodies, as in reference/plane/articulated.c.

// What a body resists with, and what hangs on it.
typedef struct Mass {
    double xx;
    double xy;
    double yy;
    Vec2 b;
    double j;
} Mass;

// Adds what hangs on a body to what it has itself.
static inline void hinged_take_gathered(HingedBody *body, Mass *mass, Vec2 *force, double *moment)
{
    const ArticulatedGathered *gathered = &body->gathered;
    mass->xx += gathered->xx;
    mass->xy += gathered->xy;
    mass->yy += gathered->yy;
    mass->b = vec2_add(mass->b, gathered->b);
    mass->j += gathered->j;
    *force = vec2_add(*force, gathered->force);
    *moment += gathered->moment;
    body->gathered = (ArticulatedGathered){.xx = 0.0};
}

// Gathers what is left of a body without its turning where it hangs.
static inline void hinged_pass_inwards(const Mass *mass, Vec2 force, double moment, double inverse,
                                       HingedBody *body)
{
    const HingedBody *parent = body->eliminated;
    const Vec2 b = mass->b;
    const Vec2 share = vec2_scale(inverse, b);
    const double xx = mass->xx - share.x * b.x;
    const double xy = mass->xy - share.x * b.y;
    const double yy = mass->yy - share.y * b.y;
    const Vec2 left = vec2_sub(force, vec2_scale(moment, share));
    const Vec2 lever =
        vec2_perp(parent->is_floating ? body->outer : vec2_sub(body->outer, parent->arm));
    const Vec2 moved = {xx * lever.x + xy * lever.y, xy * lever.x + yy * lever.y};
    body->share = share;
    body->lever = lever;
    ArticulatedGathered *to = &body->eliminated->gathered;
    to->xx += xx;
    to->xy += xy;
    to->yy += yy;
    to->b = vec2_add(to->b, moved);
    to->j += vec2_dot(lever, moved);
    to->force = vec2_add(to->force, left);
    to->moment += vec2_dot(lever, left);
}

// Solves for a body that floats.
static inline bool hinged_solve_floating(HingedBody *body, double *rates)
{
    Vec2 force = vec2_sub(body->force, vec2_scale(body->mass, body->bias));
    double moment = body->moment;
    double *own = rates + body->column;
    if (!body->has_children) {
        own[-2] = force.x / body->mass;
        own[-1] = force.y / body->mass;
        own[0] = moment / body->inertia;
        return true;
    }
    Mass mass = {body->mass, 0.0, body->mass, {0.0, 0.0}, body->inertia};
    hinged_take_gathered(body, &mass, &force, &moment);
    const double inverse = 1.0 / mass.j;
    const Vec2 share = vec2_scale(inverse, mass.b);
    const Vec2 left = vec2_sub(force, vec2_scale(moment, share));
    const double xx = mass.xx - share.x * mass.b.x;
    const double xy = mass.xy - share.x * mass.b.y;
    const double slope = xy / xx;
    const double yy = mass.yy - share.y * mass.b.y - slope * xy;
    const double y = (left.y - slope * left.x) / yy;
    body->motion = (Vec2){(left.x - xy * y) / xx, y};
    body->spin = inverse * moment - vec2_dot(share, body->motion);
    own[-2] = body->motion.x;
    own[-1] = body->motion.y;
    own[0] = body->spin;
    return mass.j > 0.0 && xx > 0.0 && yy > 0.0;
}

// Eliminates the turning of a body about its hinge.
static inline bool hinged_eliminate(HingedBody *body)
{
    Vec2 force = vec2_sub(body->force, vec2_scale(body->mass, body->bias));
    // from the hinge to the centre, turned
    const Vec2 centre = {body->arm.y, -body->arm.x};
    double moment = body->moment + vec2_dot(centre, force);
    Mass mass = {body->mass, 0.0, body->mass, vec2_scale(body->mass, centre), body->inertia};
    if (body->has_children) {
        hinged_take_gathered(body, &mass, &force, &moment);
    }
    const double inverse = 1.0 / mass.j;
    if (body->eliminated != NULL) {
        hinged_pass_inwards(&mass, force, moment, inverse, body);
    }
    body->inverse = inverse;
    body->own_moment = moment;
    return mass.j > 0.0;
}

static inline void turn(HingedBody *body, double *rates)
{
    double spin = body->inverse * body->own_moment;
    Vec2 motion = {0.0, 0.0};
    const HingedBody *parent = body->eliminated;
    if (parent != NULL) {
        motion = vec2_add(parent->motion, vec2_scale(parent->spin, body->lever));
        spin -= vec2_dot(body->share, motion);
    }
    body->motion = motion;
    body->spin = spin;
    rates[body->column] = spin;
}

// Solves for the second rates of the coordinates of bodies, of which parents stand before children;
// false where they are not determined.
static bool hinged_bodies_solve(HingedBody *bodies, size_t count, double *rates)
{
    bool is_solved = true;
    for (HingedBody *body = bodies + count; body-- > bodies;) {
        const bool is_well =
            body->is_floating ? hinged_solve_floating(body, rates) : hinged_eliminate(body);
        is_solved = is_solved && is_well;
    }
    for (HingedBody *body = bodies; body < bodies + count; body++) {
        if (!body->is_floating) {
            turn(body, rates);
        }
    }
    return is_solved;
}

// The state of a mechanism of hinges and pins in holes at one instant.
//
// As its rates are found, with what rates do not need: angles and positions, pins that are apart,
// and the forces of all hinges.

static inline void add_hinge_reaction(const HingedBody *body, const HingedBody *driven,
                                      HingedLoad *load, Vec2 reaction)
{
    HingedBody *parent = body->parent;
    const Vec2 force = vec2_scale(-1.0, reaction);
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

// From second rates: accelerations, the forces of the hinges on the bodies that they hang on, added
// to these, and on the driven one. Writes the force of each hinge on its body b, N, by joint; NULL:
// nowhere.
static void hinged_add_reactions(const Hinged *hinged, const double *rates, HingedLoad *load,
                                 Vec2 *reactions)
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
        const Vec2 reaction = vec2_sub(vec2_scale(body->mass, body->acceleration), body->force);
        if (reactions != NULL) {
            reactions[nodes[i].joint] =
                nodes[i].own_end % 2 == 1 ? reaction : vec2_scale(-1.0, reaction);
        }
        add_hinge_reaction(body, driven, load, reaction);
    }
}

// Writes where a body has moved, and how fast it does.
static inline void write_motion(const Tree *tree, int number, const HingedBody *body, double turned,
                                Motion *motions)
{
    const Motion *base = &tree->base_motions[number];
    Motion *motion = &motions[number];
    motion->position = vec2_add(base->position, body->moved);
    motion->angle = base->angle + turned;
    motion->velocity = body->velocity;
    motion->omega = body->omega;
}

static inline void write_motions(const Hinged *hinged, double since_s, const double *q,
                                 Motion *motions)
{
    const Tree *tree = &hinged->dynamics->tree;
    if (hinged->driven != NULL) {
        write_motion(tree, tree->driven, hinged->driven, hinged->driven->omega * since_s, motions);
    }
    for (size_t i = 0; i < hinged->count; i++) {
        const TreeNode *node = &tree->nodes[i];
        write_motion(tree, node->body, &hinged->bodies[i], q[node->column], motions);
    }
}

void hinged_motions(const Hinged *hinged, double since_s, const double *y, Motion *motions)
{
    hinged_move(hinged, since_s, y, y + hinged->dynamics->tree.coordinate_count);
    write_motions(hinged, since_s, y, motions);
}

static inline void write_acceleration(const HingedBody *body, Motion *motion)
{
    motion->acceleration = body->acceleration;
    motion->alpha = body->spin;
}

// Writes accelerations, and the arms of hinges.
static inline void write_accelerations(const Hinged *hinged, TreeState *state)
{
    const Tree *tree = &hinged->dynamics->tree;
    if (hinged->driven != NULL) {
        state->arms[2 * tree->linkage->driver.joint + 1] = hinged->driven->arm;
        write_acceleration(hinged->driven, &state->motions[tree->driven]);
    }
    for (size_t i = 0; i < hinged->count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const HingedBody *body = &hinged->bodies[i];
        write_acceleration(body, &state->motions[node->body]);
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
static inline void hinged_read_pin(HingedPin *pin, int pair, DynamicsState *state, ContactForce *at,
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

static void hinged_fill_rates(const Hinged *hinged, const DynamicsState *state, const double *y,
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

static bool hinged_find_state(const Hinged *hinged, double since_s, const double *y,
                              DynamicsState *state, double *rates)
{
    const Dynamics *dynamics = hinged->dynamics;
    const Tree *tree = &dynamics->tree;
    double *solved = dynamics->room.solved;
    HingedLoad load = {.power = 0.0};
    hinged_move(hinged, since_s, y, y + tree->coordinate_count);
    for (size_t i = 0; i < hinged->pin_count; i++) {
        hinged_read_pin(&hinged->pins[i], dynamics->sites[i].pair, state, &state->contacts[i],
                        &load);
        state->shared.contacts[i] = state->contacts[i].press;
    }
    if (!hinged_bodies_solve(hinged->bodies, hinged->count, solved)) {
        return false;
    }
    hinged_add_reactions(hinged, solved, &load, state->reactions);
    write_motions(hinged, since_s, y, state->tree.motions);
    write_accelerations(hinged, &state->tree);
    state->drive_power = 0.0;
    state->damping_power = 0.0;
    if (hinged->driven != NULL) {
        const Vec2 needed = hinged_needed(hinged);
        state->drive_power = vec2_dot(needed, hinged->driven->velocity) - load.power;
        state->reactions[tree->linkage->driver.joint] = vec2_sub(needed, load.force);
    }
    if (rates != NULL) {
        hinged_fill_rates(hinged, state, y, rates);
    }
    return true;
}

static bool is_hinged(const Dynamics *dynamics)
{
    const Linkage *linkage = dynamics->tree.linkage;
    bool is_plain = dynamics->articulated->is_plain && !dynamics->has_forces &&
                    dynamics->tree.drive_count <= 1 && dynamics->rub == NULL;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        is_plain = is_plain && joint_pivots(linkage->joints[i].kind);
    }
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        const PlaneSite *site = &dynamics->sites[i];
        is_plain = is_plain && site->touch.shape == TOUCH_HOLE && !site->acts_beside;
    }
    return is_plain;
}

static HingedBody *find_body(const Hinged *hinged, int body)
{
    const Tree *tree = &hinged->dynamics->tree;
    if (body == LINKAGE_GROUND) {
        return NULL;
    }
    return body == tree->driven ? hinged->driven : &hinged->bodies[tree->node_of[body]];
}

static void hinged_set_driven(Hinged *hinged)
{
    const Tree *tree = &hinged->dynamics->tree;
    *hinged->driven = (HingedBody){
        .own_base = &tree->base_arms[2 * tree->linkage->driver.joint + 1],
        .mass = tree->linkage->bodies[tree->driven].mass,
    };
}

static void set_bodies(Hinged *hinged)
{
    const Dynamics *dynamics = hinged->dynamics;
    const Tree *tree = &dynamics->tree;
    for (size_t i = 0; i < hinged->count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const ArticulatedLink *link = &dynamics->articulated->links[i];
        const bool is_floating = link->kind == LINK_FLOATING;
        hinged->bodies[i] = (HingedBody){
            .is_floating = is_floating,
            .has_children = link->has_children,
            .column = node->column,
            .mass = link->mass,
            .inertia = link->inertia,
            .weight = dynamics->weights[node->body],
        };
        if (!is_floating) {
            HingedBody *body = &hinged->bodies[i];
            body->parent = find_body(hinged, node->parent);
            body->eliminated = body->parent == hinged->driven ? NULL : body->parent;
            body->own_base = &tree->base_arms[node->own_end];
            body->outer_base = &tree->base_arms[node->parent_end];
        }
    }
}

static void hinged_set_pins(Hinged *hinged)
{
    const Dynamics *dynamics = hinged->dynamics;
    const Tree *tree = &dynamics->tree;
    for (size_t i = 0; i < hinged->pin_count; i++) {
        const int pair = dynamics->sites[i].pair;
        HingedPin *pin = &hinged->pins[i];
        *pin = (HingedPin){.contact = &dynamics->system.contacts[i], .gap = &tree->base_gaps[pair]};
        for (int side = 0; side < 2; side++) {
            const int end = 2 * pair + side;
            pin->ends[side] = (HingedEnd){
                .body = find_body(hinged, tree->end_bodies[end]),
                .is_driven = tree->driven >= 0 && tree->end_bodies[end] == tree->driven,
                .base = &tree->base_arms[end],
            };
        }
    }
}

// Adds the force of a pin to the loads, and its losses to others. Returns its size.
static inline double hinged_press(HingedPin *pin, HingedLoad *driven, double *dissipated)
{
    const Contact *contact = pin->contact;
    if (contact->mode == CONTACT_APART) {
        return 0.0;
    }
    Vec2 velocity_a;
    Vec2 velocity_b;
    const Vec2 moved_b = hinged_move_end(&pin->ends[1], &velocity_b);
    const Vec2 moved_a = hinged_move_end(&pin->ends[0], &velocity_a);
    const Vec2 gap = vec2_add(*pin->gap, vec2_sub(moved_b, moved_a));
    const PinHole pose =
        pin_hole_pose((Vec2){0.0, 0.0}, gap, vec2_sub(velocity_b, velocity_a), contact->clearance);
    const Press press = press_find(contact, -pose.gap, pose.approach_speed);
    *dissipated += press.damping_power;
    if (contact->mode != CONTACT_PRESSING) {
        return 0.0;
    }
    const Vec2 force = vec2_scale(press.normal, pose.normal);
    hinged_load_end(&pin->ends[1], velocity_b, force, driven);
    hinged_load_end(&pin->ends[0], velocity_a, vec2_scale(-1.0, force), driven);
    return sqrt(vec2_dot(force, force));
}

// The rates of any mechanism of this kind.
static bool hinged_find_rates(const Hinged *hinged, double since_s, const double *y, double *rates)
{
    const Tree *tree = &hinged->dynamics->tree;
    const size_t n = tree->coordinate_count;
    const double *u = y + n;
    double *sums = rates + 2 * n;
    hinged_move(hinged, since_s, y, u);
    HingedLoad load = {.power = 0.0};
    double dissipated = 0.0;
    for (size_t i = 0; i < hinged->pin_count; i++) {
        sums[SYSTEM_IMPULSES + i] = hinged_press(&hinged->pins[i], &load, &dissipated);
    }
    if (!hinged_bodies_solve(hinged->bodies, hinged->count, rates + n)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        rates[i] = u[i];
    }
    sums[SYSTEM_DRIVE_WORK] = 0.0;
    if (hinged->driven != NULL) {
        if (tree->is_driven_hung_on) {
            hinged_add_reactions(hinged, rates + n, &load, NULL);
        }
        sums[SYSTEM_DRIVE_WORK] =
            vec2_dot(hinged_needed(hinged), hinged->driven->velocity) - load.power;
    }
    sums[SYSTEM_DISSIPATED] = dissipated;
    sums[SYSTEM_FRICTION] = 0.0;
    return true;
}

Hinged *hinged_create(const Dynamics *dynamics)
{
    if (!is_hinged(dynamics)) {
        return NULL;
    }
    const Tree *tree = &dynamics->tree;
    const size_t count = tree->node_count;
    const size_t pin_count = dynamics->system.contact_count;
    Hinged *hinged = calloc(1, sizeof *hinged + (1 + count) * sizeof(HingedBody) +
                                   pin_count * sizeof(HingedPin));
    assert(hinged != NULL);
    HingedBody *bodies = (HingedBody *)(hinged + 1);
    *hinged = (Hinged){
        .dynamics = dynamics,
        .driven = tree->driven >= 0 ? bodies : NULL,
        .bodies = bodies + 1,
        .count = count,
        .pin_count = pin_count,
        .pins = (HingedPin *)(bodies + 1 + count),
    };
    if (hinged->driven != NULL) {
        hinged_set_driven(hinged);
    }
    set_bodies(hinged);
    hinged_set_pins(hinged);
    const bool is_pair = hinged_pair_is(hinged);
    hinged->rates = is_pair                    ? hinged_pair_rates
                    : hinged_single_is(hinged) ? hinged_single_rates
                                               : hinged_find_rates;
    hinged->evaluate = is_pair ? hinged_pair_evaluate : hinged_find_state;
    return hinged;
}

void hinged_destroy(Hinged *hinged)
{
    free(hinged);
}

bool hinged_rates(const Hinged *hinged, double since_s, const double *y, double *rates)
{
    return tree_is_steady(&hinged->dynamics->tree) && hinged->rates(hinged, since_s, y, rates);
}

bool hinged_evaluate(const Hinged *hinged, double since_s, const double *y, DynamicsState *state,
                     double *rates)
{
    return hinged->evaluate(hinged, since_s, y, state, rates);
}

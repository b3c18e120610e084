// How fast does a mechanism of hinges and pins in holes change?
//
// Outwards: where bodies have moved and how fast (reference/tree.c). Pins that are not apart press
// (reference/dynamics_contact.c). Inwards: bodies are eliminated, and outwards again: their second
// rates (reference/hinged_bodies.c). Then the drive's power (reference/dynamics.c), which needs
// the forces of the hinges on the driven body (reference/dynamics_reactions.c).
#include "reference/hinged.h"

#include "contact/pin_hole.h"
#include "reference/hinged_pair.h"

#include <assert.h>
#include <stdlib.h>

static bool is_hinged(const Dynamics *dynamics)
{
    const Linkage *linkage = dynamics->tree.linkage;
    bool is_plain = dynamics->articulated->is_plain && !dynamics->has_forces;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const JointKind kind = linkage->joints[i].kind;
        is_plain = is_plain && (kind == JOINT_REVOLUTE || kind == JOINT_CLEARANCE);
    }
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        const PlanePlace *place = &dynamics->places[i];
        is_plain = is_plain && place->touch.shape == TOUCH_HOLE && !place->acts_beside;
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

static void set_driven(Hinged *hinged)
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

static void set_pins(Hinged *hinged)
{
    const Dynamics *dynamics = hinged->dynamics;
    const Tree *tree = &dynamics->tree;
    for (size_t i = 0; i < hinged->pin_count; i++) {
        const int pair = dynamics->places[i].pair;
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
        set_driven(hinged);
    }
    set_bodies(hinged);
    set_pins(hinged);
    hinged->is_pair = hinged_pair_is(hinged);
    return hinged;
}

void hinged_destroy(Hinged *hinged)
{
    free(hinged);
}

// The drive's speed is steady.
static inline void move_driven(const DriveState *drive, double since_s, HingedBody *body)
{
    const double omega = drive->omega;
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

static inline void move_floating(HingedBody *body, const double *q, const double *u)
{
    const size_t column = body->column;
    body->turn = turned_by(q[column]);
    body->omega = u[column];
    body->arm = (Vec2){0.0, 0.0};
    body->moved = (Vec2){q[column - 2], q[column - 1]};
    body->velocity = (Vec2){u[column - 2], u[column - 1]};
    body->bias = (Vec2){0.0, 0.0};
}

static inline void move_hinged(HingedBody *body, const double *q, const double *u)
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
static inline Vec2 move_end(HingedEnd *end, Vec2 *velocity)
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

// Power and force of what acts on the driven body beside the drive.
typedef struct DrivenLoad {
    double power;
    Vec2 force;
} DrivenLoad;

static inline void load_driven(Vec2 force, Vec2 velocity, DrivenLoad *driven)
{
    driven->power += vec2_dot(force, velocity);
    driven->force = vec2_add(driven->force, force);
}

static inline void load_end(const HingedEnd *end, Vec2 velocity, Vec2 force, DrivenLoad *driven)
{
    HingedBody *body = end->body;
    if (end->is_driven) {
        load_driven(force, velocity, driven);
    } else if (body != NULL) {
        body->force = vec2_add(body->force, force);
        body->moment += vec2_cross(end->arm, force);
    }
}

// Adds the force of a pin to the loads, and its losses to others. Returns its size.
static inline double press(HingedPin *pin, DrivenLoad *driven, double *dissipated)
{
    const Contact *contact = pin->contact;
    if (contact->mode == CONTACT_APART) {
        return 0.0;
    }
    Vec2 velocity_a;
    Vec2 velocity_b;
    const Vec2 moved_b = move_end(&pin->ends[1], &velocity_b);
    const Vec2 moved_a = move_end(&pin->ends[0], &velocity_a);
    const Vec2 gap = vec2_add(*pin->gap, vec2_sub(moved_b, moved_a));
    const PinHole pose =
        pin_hole_pose((Vec2){0.0, 0.0}, gap, vec2_sub(velocity_b, velocity_a), contact->clearance);
    const Press press = press_find(contact, -pose.gap, pose.approach_speed);
    *dissipated += press.damping_power;
    if (contact->mode != CONTACT_PRESSING) {
        return 0.0;
    }
    const Vec2 force = vec2_scale(press.normal, pose.normal);
    load_end(&pin->ends[1], velocity_b, force, driven);
    load_end(&pin->ends[0], velocity_a, vec2_scale(-1.0, force), driven);
    return sqrt(vec2_dot(force, force));
}

// The acceleration of a body's centre.
static void accelerate(const double *rates, HingedBody *body)
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

// Adds the forces of the hinges on the driven body, children before parents.
static void load_hinges(const Hinged *hinged, const double *rates, DrivenLoad *load)
{
    HingedBody *driven = hinged->driven;
    driven->acceleration = driven->bias;
    driven->spin = 0.0;
    for (size_t i = 0; i < hinged->count; i++) {
        accelerate(rates, &hinged->bodies[i]);
    }
    for (size_t i = hinged->count; i-- > 0;) {
        const HingedBody *body = &hinged->bodies[i];
        HingedBody *parent = body->parent;
        if (parent == NULL) {
            continue;
        }
        const Vec2 held = vec2_sub(vec2_scale(body->mass, body->acceleration), body->force);
        const Vec2 force = vec2_scale(-1.0, held);
        if (parent == driven) {
            const Vec2 turning = vec2_scale(driven->omega, vec2_perp(body->outer));
            load_driven(force, vec2_add(driven->velocity, turning), load);
        } else {
            parent->force = vec2_add(parent->force, force);
        }
    }
}

static double drive_power(const Hinged *hinged, const DrivenLoad *load)
{
    const HingedBody *driven = hinged->driven;
    const Vec2 upward = {0.0, hinged->dynamics->system.scenario->gravity};
    const Vec2 needed = vec2_scale(driven->mass, vec2_add(driven->bias, upward));
    return vec2_dot(needed, driven->velocity) - load->power;
}

static inline void move_bodies(const Hinged *hinged, double since_s, const double *q,
                               const double *u)
{
    if (hinged->driven != NULL) {
        move_driven(&hinged->dynamics->tree.base_drive, since_s, hinged->driven);
    }
    for (size_t i = 0; i < hinged->count; i++) {
        HingedBody *body = &hinged->bodies[i];
        if (body->is_floating) {
            move_floating(body, q, u);
        } else {
            move_hinged(body, q, u);
        }
        body->force = (Vec2){0.0, -body->weight};
        body->moment = 0.0;
    }
}

bool hinged_rates(Hinged *hinged, double since_s, const double *y, double *rates)
{
    const Tree *tree = &hinged->dynamics->tree;
    const size_t n = tree->coordinate_count;
    const double *u = y + n;
    double *sums = rates + 2 * n;
    if (hinged->driven != NULL && tree->base_drive.alpha != 0.0) {
        return false;
    }
    if (hinged->is_pair) {
        return hinged_pair_rates(hinged, since_s, y, rates);
    }
    move_bodies(hinged, since_s, y, u);
    DrivenLoad load = {.power = 0.0};
    double dissipated = 0.0;
    for (size_t i = 0; i < hinged->pin_count; i++) {
        sums[SYSTEM_IMPULSES + i] = press(&hinged->pins[i], &load, &dissipated);
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
            load_hinges(hinged, rates + n, &load);
        }
        sums[SYSTEM_DRIVE_WORK] = drive_power(hinged, &load);
    }
    sums[SYSTEM_DISSIPATED] = dissipated;
    sums[SYSTEM_FRICTION] = 0.0;
    return true;
}

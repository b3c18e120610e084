// How fast does a mechanism of hinges and pins in holes change?
//
// Outwards: where bodies have moved and how fast (reference/tree.c). Pins that are not apart press
// (reference/dynamics_contact.c). Inwards: bodies are eliminated, and outwards again: their second
// rates (reference/hinged_bodies.c). Then the drive's power (reference/dynamics.c), which needs
// the forces of the hinges on the driven body (reference/dynamics_reactions.c).
#include "reference/hinged.h"

#include "kernel/pin_hole.h"
#include "reference/hinged_lone.h"
#include "reference/hinged_state.h"

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

// Adds the force of a pin to the loads, and its losses to others. Returns its size.
static inline double press(HingedPin *pin, HingedLoad *driven, double *dissipated)
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
static bool find_rates(const Hinged *hinged, double since_s, const double *y, double *rates)
{
    const Tree *tree = &hinged->dynamics->tree;
    const size_t n = tree->coordinate_count;
    const double *u = y + n;
    double *sums = rates + 2 * n;
    hinged_move(hinged, since_s, y, u);
    HingedLoad load = {.power = 0.0};
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
            hinged_hold(hinged, rates + n, &load, NULL);
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
        set_driven(hinged);
    }
    set_bodies(hinged);
    set_pins(hinged);
    const bool is_pair = hinged_pair_is(hinged);
    hinged->rates = is_pair                  ? hinged_pair_rates
                    : hinged_lone_is(hinged) ? hinged_lone_rates
                                             : find_rates;
    hinged->evaluate = is_pair ? hinged_pair_evaluate : hinged_evaluate;
    return hinged;
}

void hinged_destroy(Hinged *hinged)
{
    free(hinged);
}

bool hinged_rates(const Hinged *hinged, double since_s, const double *y, double *rates)
{
    // without a drive there is none whose speed may change
    return hinged->dynamics->tree.base_drive.alpha == 0.0 &&
           hinged->rates(hinged, since_s, y, rates);
}

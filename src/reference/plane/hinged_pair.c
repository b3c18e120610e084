// Finds the rates of the two commonest mechanisms of hinges and pins in holes: a four-bar with one
// pin in a hole, and a single body with one pin in a hole of the ground.
//
// As reference/plane/hinged.c does for any such tree, in the same order of operations, with what it
// keeps for each body in variables instead of memory: an evaluation waits for each value before it
// has the next, and a value that goes through memory is late.
#include "reference/plane/hinged.h"

#include "kernel/pin_hole.h"

// A body in motion.
typedef struct Moving {
    TurnedBy turn; // since the base
    double omega;
    Vec2 arm;   // from the centre to its hinge
    Vec2 moved; // of the centre since the base
    Vec2 velocity;
    Vec2 bias; // acceleration of the centre with all rates steady
} Moving;

// What presses on the driven body and, the other way, on the outer one.
typedef struct PairPress {
    Vec2 force;  // N, on the outer body
    double size; // N
    double moment;
    double power; // W, of the driven body's share
    double dissipated;
} PairPress;

bool hinged_pair_is(const Hinged *hinged)
{
    const HingedBody *bodies = hinged->bodies;
    if (hinged->driven == NULL || hinged->count != 2 || hinged->pin_count != 1 ||
        hinged->dynamics->tree.is_driven_hung_on || bodies[0].is_floating ||
        bodies[1].is_floating) {
        return false;
    }
    const HingedEnd *ends = hinged->pins[0].ends;
    const bool is_between = (ends[0].is_driven && ends[1].body == &bodies[1]) ||
                            (ends[1].is_driven && ends[0].body == &bodies[1]);
    return bodies[0].parent == NULL && bodies[1].parent == &bodies[0] && is_between;
}

// A body on a hinge of the ground.
static inline Moving move_on_ground(Vec2 base, double angle, double omega)
{
    Moving moving = {.turn = turned_by(angle), .omega = omega};
    const Vec2 turned = turned_arm(&moving.turn, base);
    moving.arm = vec2_add(base, turned);
    moving.moved = vec2_scale(-1.0, turned);
    moving.velocity = vec2_scale(-omega, vec2_perp(moving.arm));
    moving.bias = vec2_scale(omega * omega, moving.arm);
    return moving;
}

// One on a hinge of another, which is so far from that one's centre.
static inline Moving move_on(const Moving *parent, Vec2 outer_base, Vec2 base, double angle,
                             double omega, Vec2 *outer)
{
    Moving moving = move_on_ground(base, angle, omega);
    const double spun = parent->omega;
    const Vec2 turned = turned_arm(&parent->turn, outer_base);
    *outer = vec2_add(outer_base, turned);
    moving.moved = vec2_add(moving.moved, vec2_add(parent->moved, turned));
    moving.velocity =
        vec2_add(moving.velocity, vec2_add(parent->velocity, vec2_scale(spun, vec2_perp(*outer))));
    moving.bias = vec2_add(moving.bias, vec2_sub(parent->bias, vec2_scale(spun * spun, *outer)));
    return moving;
}

// How far an end has moved since the base.
static inline Vec2 hinged_pair_move_end(const Moving *body, Vec2 base, Vec2 *arm, Vec2 *velocity)
{
    const Vec2 turned = turned_arm(&body->turn, base);
    *arm = vec2_add(base, turned);
    *velocity = vec2_add(body->velocity, vec2_scale(body->omega, vec2_perp(*arm)));
    return vec2_add(body->moved, turned);
}

static inline PairPress hinged_pair_press(const HingedPin *pin, const Moving *driven,
                                          const Moving *outer)
{
    const Contact *contact = pin->contact;
    PairPress press = {.size = 0.0};
    if (contact->mode == CONTACT_APART) {
        return press;
    }
    const bool is_b = pin->ends[0].is_driven; // the outer body has the pin, and not the hole
    Vec2 arms[2];
    Vec2 velocities[2];
    const Vec2 moved_outer =
        hinged_pair_move_end(outer, *pin->ends[is_b ? 1 : 0].base, &arms[1], &velocities[1]);
    const Vec2 moved_driven =
        hinged_pair_move_end(driven, *pin->ends[is_b ? 0 : 1].base, &arms[0], &velocities[0]);
    const Vec2 moved = vec2_sub(moved_outer, moved_driven);
    const Vec2 speed = vec2_sub(velocities[1], velocities[0]);
    const double sense = is_b ? 1.0 : -1.0;
    const Vec2 gap = vec2_add(*pin->gap, vec2_scale(sense, moved));
    const PinHole pose =
        pin_hole_pose((Vec2){0.0, 0.0}, gap, vec2_scale(sense, speed), contact->clearance);
    const Press found = press_find(contact, -pose.gap, pose.approach_speed);
    press.dissipated = found.damping_power;
    if (contact->mode != CONTACT_PRESSING) {
        return press;
    }
    const Vec2 on_pin = vec2_scale(found.normal, pose.normal);
    press.force = vec2_scale(sense, on_pin);
    press.size = sqrt(vec2_dot(on_pin, on_pin));
    press.moment = vec2_cross(arms[1], press.force);
    press.power = vec2_dot(vec2_scale(-1.0, press.force), velocities[0]);
    return press;
}

// The second rates of both bodies; false where they are not determined.
static inline bool hinged_pair_solve(const HingedBody *bodies, const Moving *inner,
                                     const Moving *outer, Vec2 lever_arm, const PairPress *pressed,
                                     double spins[2])
{
    // the outer body, whose turning about its hinge is eliminated
    const double mass = bodies[1].mass;
    const Vec2 force =
        vec2_sub(vec2_add(bodies[1].weight, pressed->force), vec2_scale(mass, outer->bias));
    const Vec2 centre = {outer->arm.y, -outer->arm.x};
    const double moment = pressed->moment + vec2_dot(centre, force);
    const Vec2 b = vec2_scale(mass, centre);
    const double inverse = 1.0 / bodies[1].inertia;
    const Vec2 share = vec2_scale(inverse, b);
    const double xx = mass - share.x * b.x;
    const double xy = 0.0 - share.x * b.y;
    const double yy = mass - share.y * b.y;
    const Vec2 left = vec2_sub(force, vec2_scale(moment, share));
    const Vec2 lever = vec2_perp(vec2_sub(lever_arm, inner->arm));
    const Vec2 moved = {xx * lever.x + xy * lever.y, xy * lever.x + yy * lever.y};
    // the inner one with what hangs on it
    const Vec2 own_force = vec2_sub(bodies[0].weight, vec2_scale(bodies[0].mass, inner->bias));
    const Vec2 own_centre = {inner->arm.y, -inner->arm.x};
    const double own_moment = 0.0 + vec2_dot(own_centre, own_force) + vec2_dot(lever, left);
    const double inertia = bodies[0].inertia + vec2_dot(lever, moved);
    spins[0] = 1.0 / inertia * own_moment;
    const Vec2 motion = vec2_scale(spins[0], lever);
    spins[1] = inverse * moment - vec2_dot(share, motion);
    return bodies[1].inertia > 0.0 && inertia > 0.0;
}

// Rates of the integrator's vector.
static inline void hinged_pair_fill_rates(const size_t columns[2], const double *y,
                                          const double spins[2], const PairPress *pressed,
                                          double drive_power, double *rates)
{
    rates[0] = y[2];
    rates[1] = y[3];
    rates[2 + columns[0]] = spins[0];
    rates[2 + columns[1]] = spins[1];
    double *sums = rates + 4;
    sums[SYSTEM_DRIVE_WORK] = drive_power;
    sums[SYSTEM_DISSIPATED] = pressed->dissipated;
    sums[SYSTEM_FRICTION] = 0.0;
    sums[SYSTEM_IMPULSES] = pressed->size;
}

bool hinged_pair_rates(const Hinged *hinged, double since_s, const double *y, double *rates)
{
    const HingedBody *bodies = hinged->bodies;
    const double drive_omega = hinged->dynamics->tree.drives[0].base.terms[0];
    const size_t columns[2] = {bodies[0].column, bodies[1].column};
    const Moving driven =
        move_on_ground(*hinged->driven->own_base, drive_omega * since_s, drive_omega);
    const Moving inner = move_on_ground(*bodies[0].own_base, y[columns[0]], y[2 + columns[0]]);
    Vec2 lever_arm;
    const Moving outer = move_on(&inner, *bodies[1].outer_base, *bodies[1].own_base, y[columns[1]],
                                 y[2 + columns[1]], &lever_arm);
    const PairPress pressed = hinged_pair_press(&hinged->pins[0], &driven, &outer);
    double spins[2];
    const bool is_solved = hinged_pair_solve(bodies, &inner, &outer, lever_arm, &pressed, spins);
    const Vec2 upward = scenario_upward(hinged->dynamics->system.scenario);
    const Vec2 needed = vec2_scale(hinged->driven->mass, vec2_add(driven.bias, upward));
    const double drive_power = vec2_dot(needed, driven.velocity) - pressed.power;
    hinged_pair_fill_rates(columns, y, spins, &pressed, drive_power, rates);
    return is_solved;
}

// A body as a state has it, with its acceleration and how far it has turned since the base.
static inline void write_body(const Tree *tree, int number, const Moving *body, double turned,
                              Vec2 acceleration, double spin, Motion *motions)
{
    const Motion *base = &tree->base_motions[number];
    motions[number] = (Motion){
        .position = vec2_add(base->position, body->moved),
        .angle = base->angle + turned,
        .velocity = body->velocity,
        .omega = body->omega,
        .acceleration = acceleration,
        .alpha = spin,
    };
}

// Where the pin is and how it presses.
static inline PairPress hinged_pair_read_pin(const Hinged *hinged, const Moving *driven,
                                             const Moving *outer, Vec2 *arms, ContactForce *at)
{
    const HingedPin *pin = &hinged->pins[0];
    const Contact *contact = pin->contact;
    const bool is_b = pin->ends[0].is_driven; // the outer body has the pin, and not the hole
    const Moving *a = is_b ? driven : outer;
    const Moving *b = is_b ? outer : driven;
    Vec2 velocity_a;
    Vec2 velocity_b;
    const Vec2 moved_b = hinged_pair_move_end(b, *pin->ends[1].base, &arms[1], &velocity_b);
    const Vec2 moved_a = hinged_pair_move_end(a, *pin->ends[0].base, &arms[0], &velocity_a);
    const Vec2 gap = vec2_add(*pin->gap, vec2_sub(moved_b, moved_a));
    const Vec2 velocity = vec2_sub(velocity_b, velocity_a);
    const PinHole pose = pin_hole_pose((Vec2){0.0, 0.0}, gap, velocity, contact->clearance);
    const Press found = press_find(contact, -pose.gap, pose.approach_speed);
    at->pose = touch_pose_in_hole(&pose, velocity);
    at->press = found;
    at->force = (Vec2){0.0, 0.0};
    at->couple = 0.0;
    PairPress press = {.dissipated = found.damping_power};
    if (contact->mode == CONTACT_PRESSING) {
        at->force = vec2_scale(found.normal, pose.normal);
        press.force = is_b ? at->force : vec2_scale(-1.0, at->force);
        press.size = sqrt(vec2_dot(at->force, at->force));
        press.moment = vec2_cross(arms[is_b ? 1 : 0], press.force);
        press.power = vec2_dot(vec2_scale(-1.0, press.force), is_b ? velocity_a : velocity_b);
    }
    return press;
}

// The acceleration of a body's centre, whose hinge has one.
static inline Vec2 accelerate(const Moving *body, double spin, Vec2 carried)
{
    const Vec2 about = vec2_sub(vec2_scale(body->omega * body->omega, body->arm),
                                vec2_scale(spin, vec2_perp(body->arm)));
    return vec2_add(carried, about);
}

// The force of a hinge on its body b, from what its outer body needs of it.
static inline void write_reaction(const TreeNode *node, Vec2 reaction, Vec2 *reactions)
{
    reactions[node->joint] = node->own_end % 2 == 1 ? reaction : vec2_scale(-1.0, reaction);
}

// Accelerations of both bodies and the forces of their hinges.
static inline void write_bodies(const Hinged *hinged, const Moving *inner, const Moving *outer,
                                Vec2 lever_arm, const double *y, const double spins[2],
                                const PairPress *pressed, DynamicsState *state)
{
    const HingedBody *bodies = hinged->bodies;
    const Tree *tree = &hinged->dynamics->tree;
    const Vec2 inner_acceleration = accelerate(inner, spins[0], (Vec2){0.0, 0.0});
    const Vec2 turned = vec2_sub(vec2_scale(spins[0], vec2_perp(lever_arm)),
                                 vec2_scale(inner->omega * inner->omega, lever_arm));
    const Vec2 outer_acceleration =
        accelerate(outer, spins[1], vec2_add(inner_acceleration, turned));
    write_body(tree, tree->nodes[0].body, inner, y[bodies[0].column], inner_acceleration, spins[0],
               state->tree.motions);
    write_body(tree, tree->nodes[1].body, outer, y[bodies[1].column], outer_acceleration, spins[1],
               state->tree.motions);
    const Vec2 outer_force = vec2_add(bodies[1].weight, pressed->force);
    const Vec2 outer_held = vec2_sub(vec2_scale(bodies[1].mass, outer_acceleration), outer_force);
    const Vec2 inner_force = vec2_add(bodies[0].weight, vec2_scale(-1.0, outer_held));
    const Vec2 inner_held = vec2_sub(vec2_scale(bodies[0].mass, inner_acceleration), inner_force);
    write_reaction(&tree->nodes[1], outer_held, state->reactions);
    write_reaction(&tree->nodes[0], inner_held, state->reactions);
    state->tree.arms[tree->nodes[0].own_end] = inner->arm;
    state->tree.arms[tree->nodes[1].own_end] = outer->arm;
    state->tree.arms[tree->nodes[1].parent_end] = lever_arm;
}

// The driven body, with the drive's power and its joint's force.
static inline void write_driven(const Hinged *hinged, const Moving *driven, double since_s,
                                const PairPress *pressed, DynamicsState *state)
{
    const Tree *tree = &hinged->dynamics->tree;
    const int joint = tree->linkage->driver.joint;
    const Vec2 upward = scenario_upward(hinged->dynamics->system.scenario);
    const Vec2 needed = vec2_scale(hinged->driven->mass, vec2_add(driven->bias, upward));
    write_body(tree, tree->driven, driven, driven->omega * since_s, driven->bias, 0.0,
               state->tree.motions);
    state->tree.arms[2 * joint + 1] = driven->arm;
    state->reactions[joint] = vec2_add(needed, pressed->force);
    state->drive_power = vec2_dot(needed, driven->velocity) - pressed->power;
    state->damping_power = 0.0;
}

bool hinged_pair_evaluate(const Hinged *hinged, double since_s, const double *y,
                          DynamicsState *state, double *rates)
{
    const HingedBody *bodies = hinged->bodies;
    const double drive_omega = hinged->dynamics->tree.drives[0].base.terms[0];
    const size_t columns[2] = {bodies[0].column, bodies[1].column};
    const Moving driven =
        move_on_ground(*hinged->driven->own_base, drive_omega * since_s, drive_omega);
    const Moving inner = move_on_ground(*bodies[0].own_base, y[columns[0]], y[2 + columns[0]]);
    Vec2 lever_arm;
    const Moving outer = move_on(&inner, *bodies[1].outer_base, *bodies[1].own_base, y[columns[1]],
                                 y[2 + columns[1]], &lever_arm);
    ContactForce *at = &state->contacts[0];
    const size_t pair = 2 * (size_t)hinged->dynamics->sites[0].pair;
    const PairPress pressed =
        hinged_pair_read_pin(hinged, &driven, &outer, &state->tree.arms[pair], at);
    state->shared.contacts[0] = at->press;
    double spins[2];
    if (!hinged_pair_solve(bodies, &inner, &outer, lever_arm, &pressed, spins)) {
        return false;
    }
    write_bodies(hinged, &inner, &outer, lever_arm, y, spins, &pressed, state);
    write_driven(hinged, &driven, since_s, &pressed, state);
    if (rates != NULL) {
        hinged_pair_fill_rates(columns, y, spins, &pressed, state->drive_power, rates);
    }
    return true;
}

// The rates of a single body with one pin in a hole of the ground, likewise.

bool hinged_single_is(const Hinged *hinged)
{
    if (hinged->driven != NULL || hinged->count != 1 || hinged->pin_count != 1 ||
        !hinged->bodies[0].is_floating) {
        return false;
    }
    const HingedEnd *ends = hinged->pins[0].ends;
    return (ends[0].body == NULL) != (ends[1].body == NULL);
}

// What the wall does to the body.
typedef struct SinglePress {
    Vec2 force;  // N
    double size; // N
    double moment;
    double dissipated;
} SinglePress;

static inline SinglePress hinged_single_press(const HingedPin *pin, size_t column, const double *q,
                                              const double *u)
{
    const Contact *contact = pin->contact;
    SinglePress press = {.size = 0.0};
    if (contact->mode == CONTACT_APART) {
        return press;
    }
    const bool is_b = pin->ends[0].body == NULL; // the body has the pin, and not the hole
    const Vec2 nothing = {0.0, 0.0};
    const Vec2 base = *pin->ends[is_b ? 1 : 0].base;
    const TurnedBy turn = turned_by(q[column]);
    const Vec2 turned = turned_arm(&turn, base);
    const Vec2 arm = vec2_add(base, turned);
    const Vec2 centre_speed = {u[column - 2], u[column - 1]};
    const Vec2 speed = vec2_add(centre_speed, vec2_scale(u[column], vec2_perp(arm)));
    const Vec2 moved = vec2_add((Vec2){q[column - 2], q[column - 1]}, turned);
    const Vec2 apart = is_b ? vec2_sub(moved, nothing) : vec2_sub(nothing, moved);
    const Vec2 velocity = is_b ? vec2_sub(speed, nothing) : vec2_sub(nothing, speed);
    const PinHole pose =
        pin_hole_pose(nothing, vec2_add(*pin->gap, apart), velocity, contact->clearance);
    const Press found = press_find(contact, -pose.gap, pose.approach_speed);
    press.dissipated = found.damping_power;
    if (contact->mode == CONTACT_PRESSING) {
        const Vec2 on_pin = vec2_scale(found.normal, pose.normal);
        press.force = is_b ? on_pin : vec2_scale(-1.0, on_pin);
        press.size = sqrt(vec2_dot(on_pin, on_pin));
        press.moment = vec2_cross(arm, press.force);
    }
    return press;
}

bool hinged_single_rates(const Hinged *hinged, double since_s, const double *y, double *rates)
{
    enum { COORDINATES = 3 };
    (void)since_s; // nothing is driven
    const HingedBody *body = &hinged->bodies[0];
    const double *u = y + COORDINATES;
    const SinglePress pressed = hinged_single_press(&hinged->pins[0], body->column, y, u);
    const Vec2 force = vec2_add(body->weight, pressed.force);
    for (size_t i = 0; i < COORDINATES; i++) {
        rates[i] = u[i];
    }
    double *second = rates + COORDINATES + body->column;
    second[-2] = force.x / body->mass;
    second[-1] = force.y / body->mass;
    second[0] = pressed.moment / body->inertia;
    double *sums = rates + 2 * COORDINATES;
    sums[SYSTEM_DRIVE_WORK] = 0.0;
    sums[SYSTEM_DISSIPATED] = pressed.dissipated;
    sums[SYSTEM_FRICTION] = 0.0;
    sums[SYSTEM_IMPULSES] = pressed.size;
    return true;
}

// How does a linkage with play accelerate in space?
//
//     M qdd = sum over bodies  B' (F - m a_bias) + W' (N - I al_bias - w x I w) + J' lambda
//     J qdd = gamma,           M = sum  m B' B + W' I W
// B, W: velocity of each centre and angular velocity of each body by each coordinate
// (reference/space_tree.h); J, gamma: the joints that close loops (reference/space_loops.h); F, N:
// gravity and the contacts (reference/space_contact.c), N about the centre. The drive's power is
// that of what is missing from the equations of all that turns with it, along its axis.
#include "reference/space_dynamics.h"

#include "base/zeroed.h"

#include <string.h>

// A force on a body at a point on an arm from its centre. What the ground is given, nobody asks
// for.
static void load_body(SpacePush *loads, int body, Vec3 arm, Vec3 force)
{
    loads[body + 1].force = vec3_add(loads[body + 1].force, force);
    loads[body + 1].moment = vec3_add(loads[body + 1].moment, vec3_cross(arm, force));
}

static void load_moment(SpacePush *loads, int body, Vec3 moment)
{
    loads[body + 1].moment = vec3_add(loads[body + 1].moment, moment);
}

// Gravity, and nothing else yet.
static void start_loads(const SpaceDynamics *dynamics)
{
    const Linkage *linkage = dynamics->tree.linkage;
    const Vec3 none = {0.0, 0.0, 0.0};
    dynamics->loads[0] = (SpacePush){none, none};
    for (size_t i = 0; i < linkage->body_count; i++) {
        const double weight = linkage->bodies[i].mass * dynamics->system.scenario->gravity;
        dynamics->loads[i + 1] = (SpacePush){{0.0, -weight, 0.0}, none};
    }
}

// What the bodies' own equations have without second rates: F - m a_bias, N - I al_bias - w x I w.
static void find_pushes(const SpaceDynamics *dynamics, const SpaceTreeState *state)
{
    const SpaceTree *tree = &dynamics->tree;
    for (size_t i = 0; i < tree->node_count; i++) {
        const int body = tree->nodes[i].body;
        const SpaceBodyState *at = space_tree_body(state, body);
        const Mat3 inertia = space_tree_inertia(tree, state, body);
        const Vec3 held = vec3_add(mat3_apply(&inertia, at->spin_bias),
                                   vec3_cross(at->omega, mat3_apply(&inertia, at->omega)));
        const double mass = tree->linkage->bodies[body].mass;
        const SpacePush *load = &dynamics->loads[body + 1];
        dynamics->pushes[body] = (SpacePush){
            .force = vec3_sub(load->force, vec3_scale(mass, at->bias)),
            .moment = vec3_sub(load->moment, held),
        };
    }
}

// What the loops' rows ask of the second rates.
static void find_sides(const SpaceDynamics *dynamics, const SpaceTreeState *state)
{
    const SpaceLoops *loops = dynamics->loops;
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        dynamics->sides[i] =
            loops->rows[i].is_held
                ? -space_loops_bias(loops, state, i / SPACE_JOINT_ROWS, (int)(i % SPACE_JOINT_ROWS))
                : 0.0;
    }
}

// Forces and moments of the loop joints on their bodies b: the multipliers' negatives. The other
// joints have no reaction yet.
static void load_loops(const SpaceDynamics *dynamics, SpaceState *state)
{
    const SpaceTree *tree = &dynamics->tree;
    const SpaceLoops *loops = dynamics->loops;
    const double *lambda = dynamics->solved + tree->coordinate_count;
    memset(state->reactions, 0, tree->linkage->joint_count * sizeof *state->reactions);
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        if (!loops->rows[i].is_held) {
            continue;
        }
        const int joint = loops->joints[i / SPACE_JOINT_ROWS];
        const int end = 2 * joint;
        const int a = tree->ends[end].body;
        const int b = tree->ends[end + 1].body;
        const Vec3 held = vec3_scale(-lambda[i], loops->rows[i].direction);
        if (i % SPACE_JOINT_ROWS < SPACE_POINT_ROWS) {
            load_body(dynamics->loads, b, state->tree.arms[end + 1], held);
            load_body(dynamics->loads, a, state->tree.arms[end], vec3_scale(-1.0, held));
            state->reactions[joint] = vec3_add(state->reactions[joint], held);
        } else {
            load_moment(dynamics->loads, b, held);
            load_moment(dynamics->loads, a, vec3_scale(-1.0, held));
        }
    }
}

// The force that a body's acceleration asks for beyond what is known to act on it.
static Vec3 force_missing(const SpaceTree *tree, const SpaceTreeState *state,
                          const SpacePush *loads, int body)
{
    const double mass = tree->linkage->bodies[body].mass;
    return vec3_sub(vec3_scale(mass, space_tree_body(state, body)->acceleration),
                    loads[body + 1].force);
}

// Power of the drive, from the equations of all bodies that turn with it.
static void find_drive(const SpaceDynamics *dynamics, SpaceState *state)
{
    const SpacePush *loads = dynamics->loads;
    const SpaceTree *tree = &dynamics->tree;
    state->drive_power = 0.0;
    if (tree->driven < 0) {
        return;
    }
    const int end = 2 * tree->linkage->driver.joint;
    const Vec3 axis = tree->base_axes[end];
    const Vec3 pivot = tree->ends[end].anchor;
    for (int body = 0; body < (int)tree->linkage->body_count; body++) {
        if (!tree->is_carried[body]) {
            continue;
        }
        const SpaceBodyState *at = space_tree_body(&state->tree, body);
        // the driven body's own is across the axis
        Vec3 spun = {0.0, 0.0, 0.0};
        if (body != tree->driven) {
            const Mat3 inertia = space_tree_inertia(tree, &state->tree, body);
            spun = vec3_add(mat3_apply(&inertia, at->alpha),
                            vec3_cross(at->omega, mat3_apply(&inertia, at->omega)));
        }
        const Vec3 centre = vec3_add(long_vec3_round(tree->base_position[body + 1]), at->moved);
        const Vec3 turning = vec3_cross(axis, vec3_sub(centre, pivot));
        state->drive_power += vec3_dot(turning, force_missing(tree, &state->tree, loads, body)) +
                              vec3_dot(axis, vec3_sub(spun, loads[body + 1].moment));
    }
    state->drive_power *= tree->linkage->driver.speed;
}

// Reactions of the tree's joints, children before parents, and of the driven one.
static void find_reactions(const SpaceTree *tree, SpacePush *loads, SpaceState *state)
{
    for (size_t i = tree->node_count; i-- > 0;) {
        const SpaceNode *node = &tree->nodes[i];
        if (node->joint < 0) {
            continue;
        }
        const Vec3 held = force_missing(tree, &state->tree, loads, node->body);
        const bool is_child_b = tree->linkage->joints[node->joint].body_b == node->body;
        state->reactions[node->joint] = vec3_scale(is_child_b ? 1.0 : -1.0, held);
        loads[node->parent + 1].force = vec3_sub(loads[node->parent + 1].force, held);
    }
    if (tree->driven >= 0) {
        state->reactions[tree->linkage->driver.joint] =
            force_missing(tree, &state->tree, loads, tree->driven);
    }
}

// What one contact presses with.
static void find_force(const SpaceDynamics *dynamics, size_t number, SpaceState *state)
{
    const SpaceContact *contact = &dynamics->contacts[number];
    const Contact *law = &dynamics->system.contacts[number];
    SpaceForce *force = &state->forces[number];
    if (contact->is_turn) {
        space_turn_find(contact, law, &dynamics->tree, &state->tree, force);
    } else {
        space_contact_find(contact, law, &state->tree, force);
    }
}

// Positions, velocities, the contacts' forces and all loads.
static void set_up(const SpaceDynamics *dynamics, double since_s, const double *y,
                   SpaceState *state)
{
    const SpaceTree *tree = &dynamics->tree;
    const System *system = &dynamics->system;
    space_tree_evaluate(tree, since_s, y, y + tree->coordinate_count, &state->tree);
    start_loads(dynamics);
    for (size_t i = 0; i < system->contact_count; i++) {
        const SpaceContact *contact = &dynamics->contacts[i];
        SpaceForce *force = &state->forces[i];
        find_force(dynamics, i, state);
        if (contact->is_turn) {
            load_moment(dynamics->loads, contact->place.pin.body, force->couple);
            load_moment(dynamics->loads, contact->place.hole.body, vec3_scale(-1.0, force->couple));
        } else if (system->contacts[i].mode == CONTACT_PRESSING) {
            load_body(dynamics->loads, contact->place.pin.body, force->force_b, force->force);
            load_body(dynamics->loads, contact->place.hole.body, force->force_a,
                      vec3_scale(-1.0, force->force));
        }
    }
    space_loops_turn(dynamics->loops, &state->tree);
}

bool space_dynamics_factor(const SpaceDynamics *dynamics, double since_s, const double *y,
                           SpaceState *state)
{
    set_up(dynamics, since_s, y, state);
    return space_articulated_factor(dynamics->loops->articulated, &state->tree,
                                    dynamics->loops->rows);
}

// The coordinates' second rates, and the loops' multipliers behind them.
static bool find_rates(const SpaceDynamics *dynamics, double since_s, const double *y,
                       SpaceState *state)
{
    if (!space_dynamics_factor(dynamics, since_s, y, state)) {
        return false;
    }
    find_pushes(dynamics, &state->tree);
    find_sides(dynamics, &state->tree);
    space_articulated_solve(dynamics->loops->articulated, &state->tree, dynamics->pushes,
                            dynamics->sides, dynamics->solved);
    return true;
}

static void fill_sums(const SpaceDynamics *dynamics, const SpaceState *state, double *sums)
{
    sums[SYSTEM_DRIVE_WORK] = state->drive_power;
    sums[SYSTEM_DISSIPATED] = 0.0;
    sums[SYSTEM_FRICTION] = 0.0;
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        const SpaceForce *force = &state->forces[i];
        sums[SYSTEM_DISSIPATED] += force->press.damping_power;
        sums[SYSTEM_FRICTION] += force->press.friction_power;
        sums[SYSTEM_IMPULSES + i] = vec3_length(force->force) + vec3_length(force->couple);
    }
}

// Rates of the integrator's vector, from a state whose equations are solved.
static void fill_rates(const SpaceDynamics *dynamics, const SpaceState *state, const double *y,
                       double *rates)
{
    const size_t n = dynamics->tree.coordinate_count;
    for (size_t i = 0; i < n; i++) {
        rates[i] = y[n + i];
        rates[n + i] = dynamics->solved[i];
    }
    fill_sums(dynamics, state, rates + 2 * n);
}

bool space_dynamics_evaluate(const SpaceDynamics *dynamics, double since_s, const double *y,
                             SpaceState *state, double *rates)
{
    if (!find_rates(dynamics, since_s, y, state)) {
        return false;
    }
    space_tree_accelerate(&dynamics->tree, dynamics->solved, &state->tree);
    load_loops(dynamics, state);
    find_drive(dynamics, state);
    find_reactions(&dynamics->tree, dynamics->loads, state);
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        state->shared.contacts[i] = state->forces[i].press;
    }
    if (rates != NULL) {
        fill_rates(dynamics, state, y, rates);
    }
    return true;
}

Press space_dynamics_press(const SpaceDynamics *dynamics, size_t contact, double since_s,
                           const double *y)
{
    const size_t n = dynamics->tree.coordinate_count;
    SpaceState *state = dynamics->scratch;
    const PinSpace *place = &dynamics->contacts[contact].place;
    space_tree_evaluate_pair(&dynamics->tree, place->hole.body, place->pin.body, since_s, y, y + n,
                             &state->tree);
    find_force(dynamics, contact, state);
    return state->forces[contact].press;
}

void space_dynamics_rates(double since_s, const double *y, double *rates, void *context)
{
    const SpaceDynamics *dynamics = context;
    SpaceState *state = dynamics->scratch;
    if (!find_rates(dynamics, since_s, y, state)) {
        for (size_t i = 0; i < system_size(&dynamics->system); i++) {
            rates[i] = NAN;
        }
        return;
    }
    // the drive's power needs the accelerations only where the driven body carries ideal joints
    if (dynamics->tree.is_driven_hung_on) {
        space_tree_accelerate(&dynamics->tree, dynamics->solved, &state->tree);
        load_loops(dynamics, state);
    }
    find_drive(dynamics, state);
    fill_rates(dynamics, state, y, rates);
}

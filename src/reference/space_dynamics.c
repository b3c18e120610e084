// How does a linkage with play accelerate in space?
//
//     M qdd = sum over bodies  B' (F - m a_bias) + W' (N - I al_bias - w x I w) + J' lambda
//     J qdd = gamma,           M = sum  m B' B + W' I W
// B, W: velocity of each centre and angular velocity of each body by each coordinate
// (reference/space_tree.h); J, gamma: the joints that close loops (reference/space_loops.h); F, N:
// gravity and the contacts (reference/space_contact.c), N about the centre. The drive's power is
// that of what is missing from the equations of all that turns with it, along its axis.
#include "reference/space_dynamics.h"

#include "base/dense.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// Forces on the bodies, by body: at the centre, and the moment about it.
typedef struct SpaceLoads {
    Vec3 force[SPACE_TREE_BODY_MAX]; // by number + 1: what the ground is given, nobody asks for
    Vec3 moment[SPACE_TREE_BODY_MAX];
} SpaceLoads;

// What the coordinates of the tree are.
static void list_coordinates(SpaceDynamics *dynamics)
{
    const SpaceTree *tree = &dynamics->tree;
    dynamics->system.coordinate_count = tree->coordinate_count;
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        const Body *body = &tree->linkage->bodies[node->body];
        const double reach = linkage_reach(tree->linkage, node->body);
        SystemCoordinate *own = &dynamics->system.coordinates[node->first];
        if (node->joint >= 0) {
            const SpaceEnd *end = &tree->ends[node->own_end];
            const Mat3 inertia = space_inertia(body);
            const Vec3 arm = vec3_across(end->anchor, end->axis);
            own[0] = (SystemCoordinate){
                .turning = node->body,
                .reach = reach,
                .inertia = vec3_dot(end->axis, mat3_apply(&inertia, end->axis)) +
                           body->mass * vec3_dot(arm, arm),
            };
            continue;
        }
        const double least =
            fmin(fmin(body->space.inertia_x, body->space.inertia_y), body->inertia);
        for (int k = 0; k < 3; k++) {
            own[k] = (SystemCoordinate){-1, 1.0, body->mass};
            own[3 + k] = (SystemCoordinate){node->body, reach, least};
        }
    }
}

bool space_dynamics_init(const Scenario *scenario, SpaceDynamics *dynamics, Err *err)
{
    *dynamics = (SpaceDynamics){.system = {.scenario = scenario, .torn = -1}};
    System *system = &dynamics->system;
    space_tree_build(&scenario->linkage, &dynamics->tree);
    system->coordinates = calloc(dynamics->tree.coordinate_count + 1, sizeof *system->coordinates);
    system->contacts = calloc(PIN_SPACE_MAX, sizeof *system->contacts);
    assert(system->coordinates != NULL && system->contacts != NULL);
    list_coordinates(dynamics);
    PinSpace places[PIN_SPACE_MAX];
    Err failed = {ERR_NONE, ""};
    system->contact_count = pin_space_list(scenario, places, &failed);
    if (failed.kind != ERR_NONE) {
        *err = failed;
        space_dynamics_finish(dynamics);
        return false;
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        const Joint *joint = &scenario->linkage.joints[places[i].joint];
        dynamics->contacts[i].place = places[i];
        system->contacts[i] = (Contact){
            .joint = places[i].joint,
            .law = places[i].law,
            .clearance = places[i].clearance,
            .arm = 1.0,
            .flight = places[i].clearance,
            .hole_radius = joint->clearance.hole_radius,
            .is_collar = places[i].place == PIN_SPACE_COLLAR,
        };
    }
    const size_t most = 2 * SPACE_TREE_COORDINATE_MAX;
    dynamics->scratch = space_dynamics_state_create(dynamics);
    dynamics->matrix = malloc((most * most + most) * sizeof *dynamics->matrix);
    assert(dynamics->scratch != NULL && dynamics->matrix != NULL);
    dynamics->right = dynamics->matrix + most * most;
    return true;
}

void space_dynamics_finish(SpaceDynamics *dynamics)
{
    free(dynamics->system.coordinates);
    free(dynamics->system.contacts);
    free(dynamics->scratch);
    free(dynamics->matrix);
}

SpaceState *space_dynamics_state_create(const SpaceDynamics *dynamics)
{
    const size_t contacts = dynamics->system.contact_count;
    SpaceState *state = calloc(1, sizeof *state + contacts * sizeof *state->shared.contacts);
    assert(state != NULL);
    state->shared.contacts = (Press *)(state + 1);
    return state;
}

// A force on a body at a point on an arm from its centre.
static void load_body(SpaceLoads *loads, int body, Vec3 arm, Vec3 force)
{
    loads->force[body + 1] = vec3_add(loads->force[body + 1], force);
    loads->moment[body + 1] = vec3_add(loads->moment[body + 1], vec3_cross(arm, force));
}

// Gravity, and nothing else yet.
static void start_loads(const SpaceDynamics *dynamics, SpaceLoads *loads)
{
    const Linkage *linkage = dynamics->tree.linkage;
    const Vec3 none = {0.0, 0.0, 0.0};
    loads->force[0] = loads->moment[0] = none;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const double weight = linkage->bodies[i].mass * dynamics->system.scenario->gravity;
        loads->force[i + 1] = (Vec3){0.0, -weight, 0.0};
        loads->moment[i + 1] = none;
    }
}

// What a body's own equations have without second rates: F - m a_bias, N - I al_bias - w x I w.
typedef struct Push {
    Vec3 force;
    Vec3 moment;
} Push;

static Push push_of(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoads *loads,
                    const Mat3 *inertia, int body)
{
    const SpaceBodyState *at = space_tree_body(state, body);
    const Vec3 held = vec3_add(mat3_apply(inertia, at->spin_bias),
                               vec3_cross(at->omega, mat3_apply(inertia, at->omega)));
    const double mass = tree->linkage->bodies[body].mass;
    return (Push){
        .force = vec3_sub(loads->force[body + 1], vec3_scale(mass, at->bias)),
        .moment = vec3_sub(loads->moment[body + 1], held),
    };
}

// Mass matrix (n by n, in rows of `width`) and right-hand side of the coordinates; a body counts
// for the coordinates of its chain.
static void assemble(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoads *loads,
                     size_t width, double *matrix, double *right)
{
    for (size_t i = 0; i < width * width; i++) {
        matrix[i] = 0.0;
    }
    for (size_t i = 0; i < width; i++) {
        right[i] = 0.0;
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        const SpaceColumn *columns = state->columns[i];
        const Mat3 inertia = space_tree_inertia(tree, state, node->body);
        const Push push = push_of(tree, state, loads, &inertia, node->body);
        const double mass = tree->linkage->bodies[node->body].mass;
        for (size_t j = 0; j < node->chain_count; j++) {
            const size_t row = node->chain[j];
            const Vec3 heavy = vec3_scale(mass, columns[j].linear);
            const Vec3 spun = mat3_apply(&inertia, columns[j].angular);
            right[row] +=
                vec3_dot(columns[j].linear, push.force) + vec3_dot(columns[j].angular, push.moment);
            for (size_t k = 0; k <= j; k++) {
                const double product =
                    vec3_dot(heavy, columns[k].linear) + vec3_dot(spun, columns[k].angular);
                matrix[row * width + node->chain[k]] += product;
                if (k < j) {
                    matrix[node->chain[k] * width + row] += product;
                }
            }
        }
    }
}

static void append_loops(const SpaceDynamics *dynamics, const SpaceTreeState *state, size_t width,
                         double *matrix, double *right)
{
    const SpaceTree *tree = &dynamics->tree;
    const size_t n = tree->coordinate_count;
    for (size_t row = 0; row < dynamics->loops.row_count; row++) {
        double *own = matrix + (n + row) * width;
        space_loops_row(tree, state, &dynamics->loops, row, own);
        for (size_t j = 0; j < n; j++) {
            matrix[j * width + n + row] = own[j];
        }
        right[n + row] = -space_loops_bias(tree, state, &dynamics->loops, row);
    }
}

// Forces and moments of the loop joints on their bodies b: the multipliers' negatives. The other
// joints have no reaction yet.
static void load_loops(const SpaceDynamics *dynamics, const double *lambda, SpaceState *state,
                       SpaceLoads *loads)
{
    const SpaceTree *tree = &dynamics->tree;
    memset(state->reactions, 0, tree->linkage->joint_count * sizeof *state->reactions);
    for (size_t row = 0; row < dynamics->loops.row_count; row++) {
        const SpaceLoopRow *which = &dynamics->loops.rows[row];
        const int end = 2 * which->joint;
        const int a = tree->ends[end].body;
        const int b = tree->ends[end + 1].body;
        const Vec3 held = vec3_scale(
            -lambda[row], space_loops_direction(tree, &state->tree, &dynamics->loops, row));
        if (which->which < SPACE_POINT_ROWS) {
            load_body(loads, b, state->tree.arms[end + 1], held);
            load_body(loads, a, state->tree.arms[end], vec3_scale(-1.0, held));
            Vec3 *reaction = &state->reactions[which->joint];
            *reaction = vec3_add(*reaction, held);
        } else {
            loads->moment[b + 1] = vec3_add(loads->moment[b + 1], held);
            loads->moment[a + 1] = vec3_sub(loads->moment[a + 1], held);
        }
    }
}

// The force that a body's acceleration asks for beyond what is known to act on it.
static Vec3 force_missing(const SpaceTree *tree, const SpaceTreeState *state,
                          const SpaceLoads *loads, int body)
{
    const double mass = tree->linkage->bodies[body].mass;
    return vec3_sub(vec3_scale(mass, space_tree_body(state, body)->acceleration),
                    loads->force[body + 1]);
}

// Power of the drive, from the equations of all bodies that turn with it.
static void find_drive(const SpaceDynamics *dynamics, const SpaceLoads *loads, SpaceState *state)
{
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
                              vec3_dot(axis, vec3_sub(spun, loads->moment[body + 1]));
    }
    state->drive_power *= tree->linkage->driver.speed;
}

// Reactions of the tree's joints, children before parents, and of the driven one.
static void find_reactions(const SpaceTree *tree, SpaceLoads *loads, SpaceState *state)
{
    for (size_t i = tree->node_count; i-- > 0;) {
        const SpaceNode *node = &tree->nodes[i];
        if (node->joint < 0) {
            continue;
        }
        const Vec3 held = force_missing(tree, &state->tree, loads, node->body);
        const bool is_child_b = tree->linkage->joints[node->joint].body_b == node->body;
        state->reactions[node->joint] = vec3_scale(is_child_b ? 1.0 : -1.0, held);
        loads->force[node->parent + 1] = vec3_sub(loads->force[node->parent + 1], held);
    }
    if (tree->driven >= 0) {
        state->reactions[tree->linkage->driver.joint] =
            force_missing(tree, &state->tree, loads, tree->driven);
    }
}

// The equations for the coordinates' second rates (and the loops' multipliers behind them).
static void set_up(const SpaceDynamics *dynamics, double since_s, const double *y,
                   SpaceState *state, SpaceLoads *loads)
{
    const SpaceTree *tree = &dynamics->tree;
    const System *system = &dynamics->system;
    const size_t width = space_dynamics_equations(dynamics);
    space_tree_evaluate(tree, since_s, y, y + tree->coordinate_count, &state->tree);
    start_loads(dynamics, loads);
    for (size_t i = 0; i < system->contact_count; i++) {
        const SpaceContact *contact = &dynamics->contacts[i];
        SpaceForce *force = &state->forces[i];
        space_contact_find(contact, &system->contacts[i], &system->scenario->contact, &state->tree,
                           force);
        if (system->contacts[i].mode == CONTACT_PRESSING) {
            load_body(loads, contact->place.pin.body, force->force_b, force->force);
            load_body(loads, contact->place.hole.body, force->force_a,
                      vec3_scale(-1.0, force->force));
        }
    }
    assemble(tree, &state->tree, loads, width, dynamics->matrix, dynamics->right);
    append_loops(dynamics, &state->tree, width, dynamics->matrix, dynamics->right);
}

static bool find_rates(const SpaceDynamics *dynamics, double since_s, const double *y,
                       SpaceState *state, SpaceLoads *loads)
{
    set_up(dynamics, since_s, y, state, loads);
    return dense_solve(space_dynamics_equations(dynamics), dynamics->matrix, dynamics->right);
}

bool space_dynamics_factor(const SpaceDynamics *dynamics, double since_s, const double *y,
                           SpaceState *state, size_t *pivots)
{
    SpaceLoads unused;
    set_up(dynamics, since_s, y, state, &unused);
    return dense_factor(space_dynamics_equations(dynamics), dynamics->matrix, pivots);
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
        sums[SYSTEM_IMPULSES + i] = sqrt(vec3_dot(force->force, force->force));
    }
}

// Rates of the integrator's vector, from a state whose equations are solved.
static void fill_rates(const SpaceDynamics *dynamics, const SpaceState *state, const double *y,
                       double *rates)
{
    const size_t n = dynamics->tree.coordinate_count;
    for (size_t i = 0; i < n; i++) {
        rates[i] = y[n + i];
        rates[n + i] = dynamics->right[i];
    }
    fill_sums(dynamics, state, rates + 2 * n);
}

bool space_dynamics_evaluate(const SpaceDynamics *dynamics, double since_s, const double *y,
                             SpaceState *state, double *rates)
{
    SpaceLoads loads;
    if (!find_rates(dynamics, since_s, y, state, &loads)) {
        return false;
    }
    space_tree_accelerate(&dynamics->tree, dynamics->right, &state->tree);
    load_loops(dynamics, dynamics->right + dynamics->tree.coordinate_count, state, &loads);
    find_drive(dynamics, &loads, state);
    find_reactions(&dynamics->tree, &loads, state);
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
    space_tree_evaluate(&dynamics->tree, since_s, y, y + n, &state->tree);
    space_contact_find(&dynamics->contacts[contact], &dynamics->system.contacts[contact],
                       &dynamics->system.scenario->contact, &state->tree, &state->forces[contact]);
    return state->forces[contact].press;
}

void space_dynamics_rates(double since_s, const double *y, double *rates, void *context)
{
    const SpaceDynamics *dynamics = context;
    const size_t n = dynamics->tree.coordinate_count;
    SpaceState *state = dynamics->scratch;
    SpaceLoads loads;
    if (!find_rates(dynamics, since_s, y, state, &loads)) {
        for (size_t i = 0; i < system_size(&dynamics->system); i++) {
            rates[i] = NAN;
        }
        return;
    }
    // the drive's power needs the accelerations only where the driven body carries ideal joints
    if (dynamics->tree.is_driven_hung_on) {
        space_tree_accelerate(&dynamics->tree, dynamics->right, &state->tree);
        load_loops(dynamics, dynamics->right + n, state, &loads);
    }
    find_drive(dynamics, &loads, state);
    fill_rates(dynamics, state, y, rates);
}

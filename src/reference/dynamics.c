// How does a linkage with play accelerate?
//
//     M qdd = sum over bodies B^T (F - m a_bias) + moments + J^T lambda,   J qdd = gamma
// B: velocity of each centre by each coordinate (reference/tree.h), M = sum m B^T B + I; J, gamma:
// the joints that close loops. The contacts' forces: reference/dynamics_contact.c; those of
// springs, dampers and torques: model/forces.c.
#include "reference/dynamics.h"

#include "base/dense.h"
#include "model/forces.h"
#include "reference/dynamics_reactions.h"
#include "reference/loops.h"

#include <stdlib.h>
#include <string.h>

// What the coordinates of the tree are.
static void list_coordinates(Dynamics *dynamics)
{
    const Tree *tree = &dynamics->tree;
    SystemCoordinate *coordinates = dynamics->system.coordinates;
    dynamics->system.coordinate_count = tree->coordinate_count;
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const Body *body = &tree->linkage->bodies[node->body];
        SystemCoordinate *own = &coordinates[node->chain[node->chain_count - 1]];
        if (node->is_sliding) {
            *own = (SystemCoordinate){-1, 1.0, body->mass};
            continue;
        }
        *own = (SystemCoordinate){
            .turning = node->body,
            .reach = dynamics->reach[node->body],
            .inertia = body->inertia,
        };
        if (node->joint < 0) {
            own[-1] = own[-2] = (SystemCoordinate){-1, 1.0, body->mass};
        } else {
            const Vec2 arm = tree->anchors[node->own_end];
            own->inertia += body->mass * vec2_dot(arm, arm);
        }
    }
}

// m: a place that is apart is looked at before its bodies have come so much nearer. Of a stop that
// is no play, but how far the body that touches reaches from where it does.
static double flight_of(const Linkage *linkage, const Touch *touch)
{
    const Joint *joint = &linkage->joints[touch->joint];
    if (joint->kind != JOINT_STOP) {
        return linkage_radial_clearance(joint);
    }
    const int body = joint->body_b == LINKAGE_GROUND ? joint->body_a : joint->body_b;
    return touch->shape == TOUCH_DISC ? touch->clearance : linkage_reach(linkage, body);
}

static bool list_contacts(const Scenario *scenario, Dynamics *dynamics, Err *err)
{
    System *system = &dynamics->system;
    Touch *touches;
    if (!touch_list(scenario, &touches, &system->contact_count, err)) {
        return false;
    }
    if (system->contact_count > TOUCH_MAX) {
        free(touches);
        return touch_too_many(err);
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        const Touch *touch = &touches[i];
        const bool is_corner = scenario->linkage.joints[touch->joint].kind == JOINT_GUIDE;
        system->contacts[i] = (Contact){
            .joint = touch->joint,
            .law = touch->law,
            .clearance = linkage_radial_clearance(&scenario->linkage.joints[touch->joint]),
            .flight = flight_of(&scenario->linkage, touch),
        };
        dynamics->places[i] = (PlanePlace){
            .touch = *touch,
            .pair = is_corner ? dynamics->tree.corners[touch->joint] + touch->place : touch->joint,
            .acts_beside = touch->shape == TOUCH_LINE || scenario->contact.friction > 0.0,
        };
    }
    free(touches);
    return true;
}

bool dynamics_init(const Scenario *scenario, Dynamics *dynamics, Err *err)
{
    *dynamics = (Dynamics){.system = {.scenario = scenario, .torn = -1}};
    dynamics->has_forces = forces_any(&scenario->linkage);
    tree_build(&scenario->linkage, &dynamics->tree);
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        dynamics->reach[i] = linkage_reach(&scenario->linkage, (int)i);
    }
    list_coordinates(dynamics);
    const Tree *tree = &dynamics->tree;
    dynamics->may_branch = tree->loop_count > 0 && tree->coordinate_count > 2 * tree->loop_count;
    return list_contacts(scenario, dynamics, err);
}

static void load_contact(const Dynamics *dynamics, size_t number, const TreeState *state,
                         const ContactForce *force, Loads *loads)
{
    const int end = 2 * dynamics->places[number].pair;
    Vec2 from_a;
    Vec2 from_b;
    dynamics_contact_points(&dynamics->places[number], &force->pose, &from_a, &from_b);
    dynamics_load_end(&dynamics->tree, state, end + 1, from_b, force->force, loads);
    dynamics_load_end(&dynamics->tree, state, end, from_a, vec2_scale(-1.0, force->force), loads);
}

// Gravity, and nothing else yet.
static void start_loads(const Dynamics *dynamics, Loads *loads)
{
    const Tree *tree = &dynamics->tree;
    for (size_t i = 0; i < tree->node_count; i++) {
        const int body = tree->nodes[i].body;
        const double weight = tree->linkage->bodies[body].mass * dynamics->system.scenario->gravity;
        loads->force[body] = (Vec2){0.0, -weight};
        loads->moment[body] = 0.0;
    }
    loads->driven_power = 0.0;
    loads->driven_force = (Vec2){0.0, 0.0};
}

// Adds springs, dampers and a torque; fills in their powers.
static void load_forces(const Dynamics *dynamics, double since_s, DynamicsState *state,
                        Loads *loads)
{
    state->drive_power = 0.0;
    state->damping_power = 0.0;
    if (!dynamics->has_forces) {
        return;
    }
    const Tree *tree = &dynamics->tree;
    const Linkage *linkage = tree->linkage;
    const Motion *motions = state->tree.motions;
    const double time_s = tree_time(tree, since_s);
    BodyLoad added[LINKAGE_BODY_MAX];
    forces_loads(linkage, motions, time_s, added);
    for (int i = 0; i < (int)linkage->body_count; i++) {
        if (i == tree->driven) {
            loads->driven_power += forces_load_power(&added[i], &motions[i]);
            loads->driven_force = vec2_add(loads->driven_force, added[i].force);
        } else {
            loads->force[i] = vec2_add(loads->force[i], added[i].force);
            loads->moment[i] += added[i].moment;
        }
    }
    state->drive_power = forces_torque_power(linkage, motions, time_s);
    state->damping_power = forces_damping_power(linkage, motions);
}

// Mass matrix (n by n, in rows of `width`) and right-hand side of the coordinates; a body counts
// for the coordinates of its chain.
static void assemble(const Tree *tree, const TreeState *state, const Loads *loads, size_t width,
                     double *matrix, double *right)
{
    for (size_t i = 0; i < width * width; i++) {
        matrix[i] = 0.0;
    }
    for (size_t i = 0; i < width; i++) {
        right[i] = 0.0;
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const Body *body = &tree->linkage->bodies[node->body];
        const Vec2 *columns = state->columns[i];
        const Vec2 push =
            vec2_sub(loads->force[node->body], vec2_scale(body->mass, state->bias[node->body]));
        for (size_t j = 0; j < node->chain_count; j++) {
            const size_t row = node->chain[j];
            const Vec2 heavy = vec2_scale(body->mass, columns[j]);
            right[row] += vec2_dot(columns[j], push);
            for (size_t k = 0; k < j; k++) {
                const double product = vec2_dot(heavy, columns[k]);
                matrix[row * width + node->chain[k]] += product;
                matrix[node->chain[k] * width + row] += product;
            }
            matrix[row * width + row] += vec2_dot(heavy, columns[j]);
        }
        if (node->angle_column >= 0) {
            const size_t angle = (size_t)node->angle_column;
            matrix[angle * width + angle] += body->inertia;
            right[angle] += loads->moment[node->body];
        }
    }
}

static void append_loops(const Tree *tree, const TreeState *state, size_t width, double *matrix,
                         double *right)
{
    const size_t n = tree->coordinate_count;
    Vec2 row[TREE_COORDINATE_MAX];
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        const Vec2 bias = loops_bias(tree, state, loop);
        const size_t x = n + 2 * loop;
        loops_row(tree, state, loop, row);
        for (size_t j = 0; j < n; j++) {
            matrix[x * width + j] = matrix[j * width + x] = row[j].x;
            matrix[(x + 1) * width + j] = matrix[j * width + x + 1] = row[j].y;
        }
        right[x] = -bias.x;
        right[x + 1] = -bias.y;
    }
}

// Solves the equations; two coordinates, as a four-bar with one loose joint has, at once.
static bool solve(size_t width, double *matrix, double *right)
{
    if (width != 2) {
        return dense_solve(width, matrix, right);
    }
    // a mass matrix, positive definite
    const double determinant = matrix[0] * matrix[3] - matrix[1] * matrix[2];
    if (!(determinant > 0.0)) {
        return false;
    }
    const double first = (matrix[3] * right[0] - matrix[1] * right[1]) / determinant;
    right[1] = (matrix[0] * right[1] - matrix[2] * right[0]) / determinant;
    right[0] = first;
    return true;
}

// Solves for the coordinates' second rates (and the loops' multipliers behind them).
static bool find_rates(const Dynamics *dynamics, double since_s, const double *y,
                       DynamicsState *state, Loads *loads, double *solved)
{
    const Tree *tree = &dynamics->tree;
    const size_t width = dynamics_equations(dynamics);
    double matrix[DYNAMICS_EQUATION_MAX * DYNAMICS_EQUATION_MAX];
    tree_evaluate(tree, since_s, y, y + tree->coordinate_count, &state->tree);
    start_loads(dynamics, loads);
    load_forces(dynamics, since_s, state, loads);
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        dynamics_contact_find(dynamics, i, &state->tree, &state->contacts[i]);
        if (dynamics->system.contacts[i].mode == CONTACT_PRESSING) {
            load_contact(dynamics, i, &state->tree, &state->contacts[i], loads);
        }
    }
    assemble(tree, &state->tree, loads, width, matrix, solved);
    append_loops(tree, &state->tree, width, matrix, solved);
    return solve(width, matrix, solved);
}

bool dynamics_factor(const Dynamics *dynamics, const TreeState *state, double *matrix,
                     size_t *pivots)
{
    const size_t width = dynamics_equations(dynamics);
    const Loads none = {.driven_power = 0.0};
    double unused[DYNAMICS_EQUATION_MAX];
    assemble(&dynamics->tree, state, &none, width, matrix, unused);
    append_loops(&dynamics->tree, state, width, matrix, unused);
    return dense_factor(width, matrix, pivots);
}

// Power of the drive and force of the driven joint, from the driven body's own equations.
static inline void find_drive(const Dynamics *dynamics, const Loads *loads, DynamicsState *state)
{
    const Tree *tree = &dynamics->tree;
    if (tree->driven < 0) {
        return;
    }
    const Body *driven = &tree->linkage->bodies[tree->driven];
    const Motion *motion = &state->tree.motions[tree->driven];
    const Vec2 upward = {0.0, dynamics->system.scenario->gravity};
    const Vec2 needed = vec2_scale(driven->mass, vec2_add(motion->acceleration, upward));
    state->drive_power = vec2_dot(needed, motion->velocity) - loads->driven_power;
    if (motion->alpha != 0.0) {
        state->drive_power += driven->inertia * motion->alpha * motion->omega;
    }
    state->reactions[tree->linkage->driver.joint] = vec2_sub(needed, loads->driven_force);
}

static void fill_sums(const Dynamics *dynamics, const DynamicsState *state, double *sums)
{
    sums[SYSTEM_DRIVE_WORK] = state->drive_power;
    sums[SYSTEM_DISSIPATED] = state->damping_power;
    sums[SYSTEM_FRICTION] = 0.0;
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        const Vec2 force = state->contacts[i].force;
        sums[SYSTEM_DISSIPATED] += state->contacts[i].press.damping_power;
        sums[SYSTEM_FRICTION] += state->contacts[i].press.friction_power;
        sums[SYSTEM_IMPULSES + i] = sqrt(vec2_dot(force, force));
    }
}

// Rates of the integrator's vector, from a state and the coordinates' second rates.
static void fill_rates(const Dynamics *dynamics, const DynamicsState *state, const double *y,
                       const double *solved, double *rates)
{
    const size_t n = dynamics->tree.coordinate_count;
    for (size_t i = 0; i < n; i++) {
        rates[i] = y[n + i];
        rates[n + i] = solved[i];
    }
    fill_sums(dynamics, state, rates + 2 * n);
}

bool dynamics_evaluate(const Dynamics *dynamics, double since_s, const double *y,
                       DynamicsState *state, double *rates)
{
    double solved[DYNAMICS_EQUATION_MAX];
    Loads loads;
    if (!find_rates(dynamics, since_s, y, state, &loads, solved)) {
        return false;
    }
    dynamics_reactions_find(dynamics, solved, &loads, state);
    find_drive(dynamics, &loads, state);
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        state->shared.contacts[i] = state->contacts[i].press;
    }
    if (rates != NULL) {
        fill_rates(dynamics, state, y, solved, rates);
    }
    return true;
}

ContactForce dynamics_contact(const Dynamics *dynamics, size_t contact, double since_s,
                              const double *y)
{
    const Tree *tree = &dynamics->tree;
    TreeState state;
    tree_evaluate(tree, since_s, y, y + tree->coordinate_count, &state);
    ContactForce force;
    dynamics_contact_find(dynamics, contact, &state, &force);
    return force;
}

void dynamics_rates(double since_s, const double *y, double *rates, void *context)
{
    const Dynamics *dynamics = context;
    const Tree *tree = &dynamics->tree;
    const size_t n = tree->coordinate_count;
    DynamicsState state;
    Loads loads;
    double solved[DYNAMICS_EQUATION_MAX];
    double closed[2 * TREE_COORDINATE_MAX];
    if (dynamics->may_branch) {
        // with loops open by the error of a stage, the accelerations are wrong by that over the
        // distance from a change point
        memcpy(closed, y, 2 * n * sizeof *y);
        loops_project(tree, since_s, closed, closed + n);
        y = closed;
    }
    if (!find_rates(dynamics, since_s, y, &state, &loads, solved)) {
        for (size_t i = 0; i < system_size(&dynamics->system); i++) {
            rates[i] = NAN;
        }
        return;
    }
    // the drive's power needs the reactions only where the driven body carries ideal joints
    if (tree->is_driven_hung_on) {
        dynamics_reactions_find(dynamics, solved, &loads, &state);
    }
    find_drive(dynamics, &loads, &state);
    fill_rates(dynamics, &state, y, solved, rates);
}

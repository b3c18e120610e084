// How does a linkage with play accelerate?
//
//     M qdd = sum over bodies B^T (F - m a_bias) + moments + J^T lambda,   J qdd = gamma
// B: velocity of each centre by each coordinate (reference/tree.h), M = sum m B^T B + I; J, gamma:
// the joints that close loops. Solved body by body: reference/articulated.h. The contacts' forces:
// reference/dynamics_contact.c; those of springs, dampers and torques: model/forces.c.
#include "reference/dynamics.h"

#include "base/zeroed.h"
#include "model/forces.h"
#include "reference/dynamics_places.h"
#include "reference/dynamics_reactions.h"
#include "reference/hinged.h"
#include "reference/hinged_state.h"
#include "reference/loops.h"

#include <assert.h>
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
        SystemCoordinate *own = &coordinates[node->column];
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

// All arrays, from a layout that counts or has the memory.
static void lay(Dynamics *dynamics, size_t contact_most, Layout *layout)
{
    const Linkage *linkage = dynamics->tree.linkage;
    const size_t bodies = linkage->body_count;
    const size_t n = dynamics->tree.coordinate_count;
    const size_t rows = 2 * dynamics->tree.loop_count;
    System *system = &dynamics->system;
    DynamicsRoom *room = &dynamics->room;
    system->coordinates = layout_take(layout, n, sizeof *system->coordinates);
    system->contacts = layout_take(layout, contact_most, sizeof *system->contacts);
    dynamics->places = layout_take(layout, contact_most, sizeof *dynamics->places);
    dynamics->reach = layout_take(layout, bodies, sizeof *dynamics->reach);
    dynamics->weights = layout_take(layout, bodies, sizeof *dynamics->weights);
    room->loads.pushes = layout_take(layout, bodies, sizeof *room->loads.pushes);
    room->zeros = layout_take(layout, bodies, sizeof *room->zeros);
    room->added = layout_take(layout, bodies, sizeof *room->added);
    room->sides = layout_take(layout, rows, sizeof *room->sides);
    room->solved = layout_take(layout, n + rows, sizeof *room->solved);
    room->closed = layout_take(layout, 2 * n, sizeof *room->closed);
    room->row = layout_take(layout, n, sizeof *room->row);
    room->arms = layout_take(layout, n, sizeof *room->arms);
    for (int i = 0; i < DYNAMICS_PUSHED; i++) {
        room->pushed[i] = layout_take(layout, n + rows, sizeof *room->pushed[i]);
    }
}

static void make_room(Dynamics *dynamics)
{
    const Linkage *linkage = dynamics->tree.linkage;
    const size_t contact_most = TOUCH_CORNERS * linkage->joint_count;
    Layout layout = {NULL, 0};
    lay(dynamics, contact_most, &layout);
    dynamics->memory = calloc(1, layout.used + 1);
    assert(dynamics->memory != NULL);
    lay(dynamics, contact_most, &(Layout){dynamics->memory, 0});
}

static Coupling *couple(const Dynamics *dynamics)
{
    const Tree *tree = &dynamics->tree;
    const ArticulatedParts *parts = &dynamics->articulated->parts;
    CouplingBody *bodies = zeroed(tree->node_count, sizeof *bodies);
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const size_t before = node->joint < 0 ? 2 : 0; // a floating body's x and y
        bodies[i] =
            (CouplingBody){node->body, parts->of_node[i], node->column - before, 1 + before};
    }
    Coupling *coupling = coupling_create(tree->linkage, parts->count, tree->node_count, bodies);
    free(bodies);
    return coupling;
}

bool dynamics_init(const Scenario *scenario, Dynamics *dynamics, Err *err)
{
    *dynamics = (Dynamics){.system = {.scenario = scenario, .torn = -1}};
    const Linkage *linkage = &scenario->linkage;
    Tree *tree = &dynamics->tree;
    dynamics->has_forces = forces_any(linkage);
    tree_build(linkage, tree);
    make_room(dynamics);
    linkage_reaches(linkage, dynamics->reach);
    for (size_t i = 0; i < linkage->body_count; i++) {
        dynamics->weights[i] = linkage->bodies[i].mass * scenario->gravity;
    }
    list_coordinates(dynamics);
    dynamics->may_branch = tree->loop_count > 0 && tree->coordinate_count > 2 * tree->loop_count;
    if (!dynamics_places_list(scenario, dynamics, err)) {
        dynamics_finish(dynamics);
        return false;
    }
    dynamics->articulated = articulated_create(tree, tree->loop_count, tree->loops);
    dynamics->system.coupling = couple(dynamics);
    dynamics->hinged = hinged_create(dynamics);
    dynamics->room.state = dynamics_state_create(dynamics);
    return true;
}

void dynamics_finish(Dynamics *dynamics)
{
    free(dynamics->room.state);
    hinged_destroy(dynamics->hinged);
    coupling_destroy(dynamics->system.coupling);
    articulated_destroy(dynamics->articulated);
    free(dynamics->memory);
    tree_finish(&dynamics->tree);
}

static void lay_state(const Dynamics *dynamics, Layout *layout, DynamicsState *state)
{
    const size_t contacts = dynamics->system.contact_count;
    const size_t joints = dynamics->tree.linkage->joint_count;
    layout_take(layout, 1, sizeof *state);
    state->shared.contacts = layout_take(layout, contacts, sizeof *state->shared.contacts);
    tree_state_lay(&dynamics->tree, layout, &state->tree);
    state->contacts = layout_take(layout, contacts, sizeof *state->contacts);
    state->reactions = layout_take(layout, joints, sizeof *state->reactions);
    state->couples = layout_take(layout, joints, sizeof *state->couples);
}

DynamicsState *dynamics_state_create(const Dynamics *dynamics)
{
    DynamicsState counted;
    Layout layout = {NULL, 0};
    lay_state(dynamics, &layout, &counted);
    DynamicsState *state = calloc(1, layout.used);
    assert(state != NULL);
    lay_state(dynamics, &(Layout){(char *)state, 0}, state);
    return state;
}

LoopsRoom dynamics_loops(const Dynamics *dynamics)
{
    const DynamicsRoom *room = &dynamics->room;
    return (LoopsRoom){
        .tree = &dynamics->tree,
        .loop_count = dynamics->tree.loop_count,
        .loops = dynamics->tree.loops,
        .articulated = dynamics->articulated,
        .state = &room->state->tree,
        .pushes = room->zeros,
        .sides = room->sides,
        .solved = room->solved,
    };
}

static void load_contact(const Dynamics *dynamics, size_t number, const TreeState *state,
                         const ContactForce *force, Loads *loads)
{
    const int end = 2 * dynamics->places[number].pair;
    Vec2 from_a;
    Vec2 from_b;
    if (force->couple != 0.0) {
        const Tree *tree = &dynamics->tree;
        dynamics_load_couple(tree, state, tree->end_bodies[end + 1], force->couple, loads);
        dynamics_load_couple(tree, state, tree->end_bodies[end], -force->couple, loads);
        return;
    }
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
        loads->pushes[body] = (ArticulatedPush){{0.0, -dynamics->weights[body]}, 0.0};
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
    BodyLoad *added = dynamics->room.added;
    forces_loads(linkage, motions, time_s, added);
    for (int i = 0; i < (int)linkage->body_count; i++) {
        if (i == tree->driven) {
            loads->driven_power += forces_load_power(&added[i], &motions[i]);
            loads->driven_force = vec2_add(loads->driven_force, added[i].force);
        } else {
            ArticulatedPush *push = &loads->pushes[i];
            push->force = vec2_add(push->force, added[i].force);
            push->moment += added[i].moment;
        }
    }
    state->drive_power = forces_torque_power(linkage, motions, time_s);
    state->damping_power = forces_damping_power(linkage, motions);
}

// Solves for the coordinates' second rates (and the loops' multipliers behind them), into the room;
// where loops have just been closed at these coordinates, by the elimination that closed them.
static bool find_rates(const Dynamics *dynamics, double since_s, const double *y, bool are_closed,
                       DynamicsState *state, Loads *loads)
{
    const Tree *tree = &dynamics->tree;
    const DynamicsRoom *room = &dynamics->room;
    tree_evaluate(tree, since_s, y, y + tree->coordinate_count, &state->tree);
    start_loads(dynamics, loads);
    load_forces(dynamics, since_s, state, loads);
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        dynamics_contact_find(dynamics, i, &state->tree, &state->contacts[i]);
        if (dynamics->system.contacts[i].mode == CONTACT_PRESSING) {
            load_contact(dynamics, i, &state->tree, &state->contacts[i], loads);
        }
    }
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        const Vec2 bias = loops_bias(tree, &state->tree, loop);
        room->sides[2 * loop] = -bias.x;
        room->sides[2 * loop + 1] = -bias.y;
    }
    return (are_closed ? articulated_accelerate_again : articulated_accelerate)(
        dynamics->articulated, &state->tree, loads->pushes, room->sides, room->solved);
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
        sums[SYSTEM_IMPULSES + i] = sqrt(vec2_dot(force, force)) + fabs(state->contacts[i].couple);
    }
}

// Rates of the integrator's vector, from a state whose equations are solved.
static void fill_rates(const Dynamics *dynamics, const DynamicsState *state, const double *y,
                       double *rates)
{
    const size_t n = dynamics->tree.coordinate_count;
    for (size_t i = 0; i < n; i++) {
        rates[i] = y[n + i];
        rates[n + i] = dynamics->room.solved[i];
    }
    fill_sums(dynamics, state, rates + 2 * n);
}

bool dynamics_evaluate(const Dynamics *dynamics, double since_s, const double *y,
                       DynamicsState *state, double *rates)
{
    if (dynamics->hinged != NULL && dynamics->tree.base_drive.alpha == 0.0) {
        return dynamics->hinged->evaluate(dynamics->hinged, since_s, y, state, rates);
    }
    Loads loads = dynamics->room.loads;
    if (!find_rates(dynamics, since_s, y, false, state, &loads)) {
        return false;
    }
    dynamics_reactions_find(dynamics, dynamics->room.solved, &loads, state);
    find_drive(dynamics, &loads, state);
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        state->shared.contacts[i] = state->contacts[i].press;
    }
    if (rates != NULL) {
        fill_rates(dynamics, state, y, rates);
    }
    return true;
}

ContactForce dynamics_contact(const Dynamics *dynamics, size_t contact, double since_s,
                              const double *y)
{
    const Tree *tree = &dynamics->tree;
    TreeState *state = &dynamics->room.state->tree;
    const double *u = y + tree->coordinate_count;
    if (dynamics->places[contact].touch.shape == TOUCH_TEETH) {
        tree_evaluate(tree, since_s, y, u, state); // their carrier counts, too
    } else {
        tree_evaluate_pair(tree, dynamics->places[contact].pair, since_s, y, u, state);
    }
    ContactForce force;
    dynamics_contact_find(dynamics, contact, state, &force);
    return force;
}

size_t dynamics_contact_needs(const System *system, size_t contact, size_t *coordinates)
{
    const Dynamics *dynamics = (const Dynamics *)system;
    const PlanePlace *place = &dynamics->places[contact];
    return place->touch.shape == TOUCH_TEETH
               ? 0
               : tree_pair_coordinates(&dynamics->tree, place->pair, coordinates);
}

// The rates of any mechanism; apart from the shorter way, so that this sets up nothing for it.
__attribute__((noinline)) static void find_all_rates(const Dynamics *dynamics, double since_s,
                                                     const double *y, double *rates)
{
    const Tree *tree = &dynamics->tree;
    const size_t n = tree->coordinate_count;
    DynamicsState *state = dynamics->room.state;
    Loads loads = dynamics->room.loads;
    const double *solved = dynamics->room.solved;
    if (dynamics->may_branch) {
        // with loops open by the error of a stage, the accelerations are wrong by that over the
        // distance from a change point
        double *closed = dynamics->room.closed;
        const LoopsRoom room = dynamics_loops(dynamics);
        memcpy(closed, y, 2 * n * sizeof *y);
        loops_project(&room, since_s, closed, closed + n);
        y = closed;
    }
    if (!find_rates(dynamics, since_s, y, dynamics->may_branch, state, &loads)) {
        for (size_t i = 0; i < system_size(&dynamics->system); i++) {
            rates[i] = NAN;
        }
        return;
    }
    // the drive's power needs the reactions only where the driven body carries ideal joints
    if (tree->is_driven_hung_on) {
        dynamics_reactions_find(dynamics, solved, &loads, state);
    }
    find_drive(dynamics, &loads, state);
    fill_rates(dynamics, state, y, rates);
}

void dynamics_rates(double since_s, const double *y, double *rates, void *context)
{
    const Dynamics *dynamics = context;
    if (dynamics->hinged == NULL || !hinged_rates(dynamics->hinged, since_s, y, rates)) {
        find_all_rates(dynamics, since_s, y, rates);
    }
}

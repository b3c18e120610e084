// What do the equations of motion in space need, and of which size?
#include "base/zeroed.h"
#include "reference/space_dynamics.h"

// What the coordinates of the tree are.
static void list_coordinates(SpaceDynamics *dynamics)
{
    const SpaceTree *tree = &dynamics->tree;
    dynamics->system.coordinate_count = tree->coordinate_count;
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        const Body *body = &tree->linkage->bodies[node->body];
        const double reach = tree->reaches[node->body];
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

static void set_pins(SpaceDynamics *dynamics, const PinSpace *places, size_t count)
{
    System *system = &dynamics->system;
    system->contact_count = count;
    for (size_t i = 0; i < count; i++) {
        const Joint *joint = &system->scenario->linkage.joints[places[i].joint];
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
}

// The ends of limited angles, behind the pins.
static bool add_turns(SpaceDynamics *dynamics, Err *err)
{
    const Scenario *scenario = dynamics->system.scenario;
    for (int i = 0; i < (int)scenario->linkage.joint_count; i++) {
        size_t *count = &dynamics->system.contact_count;
        if (scenario->linkage.joints[i].limits.kind != LIMIT_NONE) {
            const size_t added =
                space_turn_list(scenario, &dynamics->tree, i, dynamics->contacts + *count,
                                dynamics->system.contacts + *count, err);
            if (added == 0) {
                return false;
            }
            *count += added;
        }
    }
    return true;
}

static Coupling *couple(const SpaceDynamics *dynamics)
{
    const SpaceTree *tree = &dynamics->tree;
    const ArticulatedParts *parts = &dynamics->loops->articulated->parts;
    CouplingBody *bodies = zeroed(tree->node_count, sizeof *bodies);
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        bodies[i] = (CouplingBody){node->body, parts->of_node[i], node->first,
                                   space_loop_groups_freedoms(node)};
    }
    Coupling *coupling = coupling_create(tree->linkage, parts->count, tree->node_count, bodies);
    free(bodies);
    return coupling;
}

bool space_dynamics_init(const Scenario *scenario, SpaceDynamics *dynamics, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    size_t count;
    PinSpace *places = pin_space_list(scenario, &count, err);
    if (places == NULL) {
        return false;
    }
    *dynamics = (SpaceDynamics){.system = {.scenario = scenario, .torn = -1}};
    System *system = &dynamics->system;
    SpaceTree *tree = &dynamics->tree;
    space_tree_build(linkage, tree);
    dynamics->loops = space_loops_create(tree, tree->loop_count, tree->loops);
    system->coordinates = zeroed(tree->coordinate_count, sizeof *system->coordinates);
    list_coordinates(dynamics);
    system->coupling = couple(dynamics);
    const size_t most = count + 2 * linkage->joint_count;
    system->contacts = zeroed(most, sizeof *system->contacts);
    dynamics->contacts = zeroed(most, sizeof *dynamics->contacts);
    set_pins(dynamics, places, count);
    free(places);
    if (!add_turns(dynamics, err)) {
        space_dynamics_finish(dynamics);
        return false;
    }
    const size_t rows = SPACE_JOINT_ROWS * tree->loop_count;
    dynamics->scratch = space_dynamics_state_create(dynamics);
    dynamics->loads = zeroed(linkage->body_count + 1, sizeof *dynamics->loads);
    dynamics->pushes = zeroed(linkage->body_count, sizeof *dynamics->pushes);
    dynamics->sides = zeroed(rows, sizeof *dynamics->sides);
    dynamics->solved = zeroed(tree->coordinate_count + rows, sizeof *dynamics->solved);
    return true;
}

void space_dynamics_finish(SpaceDynamics *dynamics)
{
    space_tree_finish(&dynamics->tree);
    space_loops_destroy(dynamics->loops);
    coupling_destroy(dynamics->system.coupling);
    free(dynamics->system.coordinates);
    free(dynamics->system.contacts);
    free(dynamics->contacts);
    free(dynamics->scratch);
    free(dynamics->loads);
    free(dynamics->pushes);
    free(dynamics->sides);
    free(dynamics->solved);
}

// All of a state, from a layout that counts or has the memory.
static SpaceState *lay_state(const SpaceDynamics *dynamics, Layout *layout)
{
    const size_t contacts = dynamics->system.contact_count;
    SpaceState *own = layout_take(layout, 1, sizeof *own);
    SpaceState state = {.drive_power = 0.0};
    state.shared.contacts = layout_take(layout, contacts, sizeof *state.shared.contacts);
    space_tree_state_lay(&dynamics->tree, layout, &state.tree);
    state.forces = layout_take(layout, contacts, sizeof *state.forces);
    state.reactions =
        layout_take(layout, dynamics->tree.linkage->joint_count, sizeof *state.reactions);
    if (own != NULL) {
        *own = state;
    }
    return own;
}

SpaceState *space_dynamics_state_create(const SpaceDynamics *dynamics)
{
    Layout layout = {NULL, 0};
    lay_state(dynamics, &layout);
    return lay_state(dynamics, &(Layout){zeroed(layout.used, 1), 0});
}

// Presents the equations of motion in space as a system to those who step through them.
#include "reference/space/space_dynamics.h"

#include "base/zeroed.h"
#include "model/coordinate.h"
#include "reference/system.h"

static SpaceDynamics *own_dynamics(System *system)
{
    return (SpaceDynamics *)system;
}

static const SpaceDynamics *space_dynamics_of(const System *system)
{
    return (const SpaceDynamics *)system;
}

static const SpaceState *space_state_of(const SystemState *state)
{
    return (const SpaceState *)state;
}

static void rebase_contacts(SpaceDynamics *dynamics)
{
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        if (!dynamics->contacts[i].is_turn) {
            space_contact_rebase(&dynamics->tree, &dynamics->contacts[i]);
        }
    }
}

static void space_begin(System *system, double *y)
{
    SpaceDynamics *dynamics = own_dynamics(system);
    const size_t n = dynamics->tree.coordinate_count;
    SpaceMotion *motions = zeroed(dynamics->tree.linkage->body_count, sizeof *motions);
    space_start(dynamics->tree.linkage, motions);
    space_tree_start(&dynamics->tree, motions, y + n);
    space_loops_start(&dynamics->tree, dynamics->loops, y, y + n, &dynamics->scratch->tree);
    free(motions);
    rebase_contacts(dynamics);
}

static bool space_evaluate(const System *system, double since_s, const double *y,
                           SystemState *state, double *rates)
{
    return space_dynamics_evaluate(space_dynamics_of(system), since_s, y, (SpaceState *)state,
                                   rates);
}

static Press space_press(const System *system, size_t contact, double since_s, const double *y)
{
    return space_dynamics_press(space_dynamics_of(system), contact, since_s, y);
}

static size_t space_needs(const System *system, size_t contact, size_t *coordinates)
{
    const PinSpace *site = &space_dynamics_of(system)->contacts[contact].site;
    return space_tree_pair_coordinates(&space_dynamics_of(system)->tree, site->hole.body,
                                       site->pin.body, coordinates);
}

static void space_sizes(const System *system, const SystemState *state, size_t contact,
                        double *length, double *speed)
{
    const SpaceDynamics *dynamics = space_dynamics_of(system);
    const SpaceForce *force = &space_state_of(state)->forces[contact];
    const SpaceContact *end = &dynamics->contacts[contact];
    if (end->is_turn) {
        const int joint = end->site.joint;
        const SpaceTreeState *tree = &space_state_of(state)->tree;
        *length += 2.0 * fabs(dynamics->tree.base_coordinates[joint]) + fabs(end->limit);
        *speed += vec3_length(space_tree_body(tree, end->site.hole.body)->omega) +
                  vec3_length(space_tree_body(tree, end->site.pin.body)->omega);
        return;
    }
    const int bodies[2] = {dynamics->contacts[contact].site.hole.body,
                           dynamics->contacts[contact].site.pin.body};
    const Vec3 arms[2] = {force->from_a, force->from_b};
    for (int side = 0; side < 2; side++) {
        const SpaceBodyState *at = space_tree_body(&space_state_of(state)->tree, bodies[side]);
        const Vec3 base = long_vec3_round(dynamics->tree.base_position[bodies[side] + 1]);
        const double arm = vec3_length(arms[side]);
        *length += vec3_length(vec3_add(base, arms[side])) + arm;
        *speed += vec3_length(at->velocity) + 2.0 * arm * vec3_length(at->omega);
    }
}

static double space_crossing(const System *system, const SystemState *state, size_t number)
{
    const SpaceContact *contact = &space_dynamics_of(system)->contacts[number];
    const SpaceTreeState *tree = &space_state_of(state)->tree;
    const SpaceForce *force = &space_state_of(state)->forces[number];
    if (contact->is_turn) {
        const SpaceTree *of = &space_dynamics_of(system)->tree;
        const int joint = contact->site.joint;
        return fabs(space_turn_rate(of, tree, joint)) +
               sqrt(system->contacts[number].flight * fabs(space_turn_second(of, tree, joint)));
    }
    const Vec3 w = force->relative;
    const Vec3 a = vec3_sub(space_tree_acceleration(tree, contact->site.pin.body, force->from_b),
                            space_tree_acceleration(tree, contact->site.hole.body, force->from_a));
    const double clearance = system->contacts[number].clearance;
    if (system->contacts[number].is_collar) {
        return fabs(vec3_dot(w, force->axis)) + sqrt(clearance * fabs(vec3_dot(a, force->axis)));
    }
    return vec3_length(vec3_across(w, force->axis)) +
           sqrt(clearance * vec3_length(vec3_across(a, force->axis)));
}

static double space_fastest(const System *system, const SystemState *state)
{
    const SpaceTree *tree = &space_dynamics_of(system)->tree;
    double fastest = 0.0;
    for (size_t i = 0; i < tree->node_count; i++) {
        const int body = tree->nodes[i].body;
        const SpaceBodyState *at = space_tree_body(&space_state_of(state)->tree, body);
        const double turning = vec3_length(at->omega) * tree->reaches[body];
        fastest = fmax(fastest, vec3_length(at->velocity) + turning);
    }
    return fastest;
}

// The force is that of both ends of a pin together, as it is reported.
static void space_peak(const System *system, const SystemState *state, size_t number,
                       double values[2], double rates[2])
{
    const SpaceState *at = space_state_of(state);
    const Contact *contact = &system->contacts[number];
    values[0] = rates[0] = 0.0;
    values[1] = at->forces[number].press.depth;
    rates[1] = at->forces[number].press.closing;
    const SpaceContact *own = &space_dynamics_of(system)->contacts[number];
    if (own->is_turn) {
        const SpaceTree *tree = &space_dynamics_of(system)->tree;
        const double second = -own->sign * space_turn_second(tree, &at->tree, own->site.joint);
        values[0] = at->forces[number].press.normal;
        rates[0] = press_rate(contact, &at->forces[number].press, second);
        return;
    }
    // the sites of a joint stand together
    size_t first = number;
    while (first > 0 && system->contacts[first - 1].joint == contact->joint) {
        first--;
    }
    for (size_t i = first; i < system->contact_count && system->contacts[i].joint == contact->joint;
         i++) {
        const Contact *other = &system->contacts[i];
        if (other->is_collar == contact->is_collar && other->mode == CONTACT_PRESSING) {
            const double second = space_contact_second(&space_dynamics_of(system)->contacts[i],
                                                       &at->tree, &at->forces[i]);
            values[0] += at->forces[i].press.normal;
            rates[0] += press_rate(other, &at->forces[i].press, second);
        }
    }
}

static void space_project(const System *system, double since_s, double *y)
{
    const SpaceDynamics *dynamics = space_dynamics_of(system);
    const size_t n = dynamics->tree.coordinate_count;
    space_loops_project(dynamics->loops, since_s, y, y + n, &dynamics->scratch->tree);
}

static bool space_rebase(System *system, double since_s, double *y)
{
    SpaceDynamics *dynamics = own_dynamics(system);
    SpaceTree *tree = &dynamics->tree;
    const size_t n = tree->coordinate_count;
    space_project(system, since_s, y);
    space_tree_rebase(tree, since_s, y, y + n);
    rebase_contacts(dynamics);
    if (tree->loop_count > 0) {
        space_tree_evaluate(tree, 0.0, y, y + n, &dynamics->scratch->tree);
        space_loops_choose(dynamics->loops, &dynamics->scratch->tree, false);
        system->torn = space_loops_torn(dynamics->loops, &dynamics->scratch->tree);
    }
    // the turns of floating bodies have other rates from their new base on
    return tree->has_floating || tree->loop_count > 0;
}

static void space_carry(System *system, Carry *carry)
{
    SpaceDynamics *dynamics = own_dynamics(system);
    carry_bytes(carry, dynamics->tree.memory, dynamics->tree.memory_size);
    CARRY(carry, dynamics->tree.base_time_s);
    CARRY_ARRAY(carry, dynamics->contacts, system->contact_count);
}

static double space_time(const System *system, double since_s)
{
    return (double)(space_dynamics_of(system)->tree.base_time_s + since_s);
}

static double space_since(const System *system, double time_s)
{
    return (double)(time_s - space_dynamics_of(system)->tree.base_time_s);
}

static void space_turning(const System *system, const SystemState *state, double *omega,
                          double *alpha)
{
    for (int i = 0; i < (int)system->scenario->linkage.body_count; i++) {
        omega[i] = space_tree_body(&space_state_of(state)->tree, i)->omega.z;
        alpha[i] = space_tree_body(&space_state_of(state)->tree, i)->alpha.z;
    }
}

static void fill_ideal_joint(const Vec3 *reaction, Vec3 gap, JointState *joint,
                             SpaceJointState *space_joint)
{
    *joint = (JointState){
        .eccentricity = {gap.x, gap.y},
        .force_on_b = {reaction->x, reaction->y},
        .force = vec3_length(*reaction),
        .is_touching = true,
    };
    *space_joint = (SpaceJointState){.force_on_b = *reaction, .offset = gap};
}

// What a pin's sites say of it, beginning with the first end.
static void fill_pin_joint(const System *system, const SpaceState *at, size_t first,
                           JointState *joint, SpaceJointState *space_joint)
{
    const SpaceTree *tree = &space_dynamics_of(system)->tree;
    const int number = system->contacts[first].joint;
    const Vec3 gap = space_tree_gap(tree, &at->tree, number);
    const Vec3 hole = space_tree_axis(tree, &at->tree, 2 * number);
    const Vec3 pin = space_tree_axis(tree, &at->tree, 2 * number + 1);
    *joint = (JointState){.eccentricity = {gap.x, gap.y}, .gap = INFINITY};
    *space_joint = (SpaceJointState){
        .offset = gap,
        .tilt = atan2(vec3_length(vec3_cross(hole, pin)), vec3_dot(hole, pin)),
        .axial = vec3_dot(hole, gap),
    };
    for (size_t i = first; i < system->contact_count && system->contacts[i].joint == number; i++) {
        const SpaceForce *force = &at->forces[i];
        const double size = vec3_length(force->force);
        space_joint->force_on_b = vec3_add(space_joint->force_on_b, force->force);
        if (system->contacts[i].is_collar) {
            space_joint->axial_force = vec3_dot(hole, force->force);
            continue;
        }
        space_joint->ends[i - first] = force->offset;
        space_joint->end_gaps[i - first] = -force->press.depth;
        space_joint->end_forces[i - first] = size;
        joint->gap = fmin(joint->gap, -force->press.depth);
        joint->force += size;
        joint->is_touching = joint->is_touching || system->contacts[i].mode != CONTACT_APART;
    }
    joint->force_on_b = (Vec2){space_joint->force_on_b.x, space_joint->force_on_b.y};
}

// A joint whose angle is limited: what it holds stays in the force on its body b; its size is that
// of what presses.
static void fill_limited_joint(const System *system, const SpaceState *at, int number,
                               JointState *joint)
{
    joint->tilt = space_turn_angle(&space_dynamics_of(system)->tree, &at->tree, number);
    joint->gap = INFINITY;
    joint->force = 0.0;
    joint->is_touching = false;
}

// Adds what one of its ends does.
static void fill_limit(const System *system, const SpaceState *at, size_t number, JointState *joint)
{
    const SpaceContact *end = &space_dynamics_of(system)->contacts[number];
    const Press *press = &at->forces[number].press;
    const Joint *of = &system->scenario->linkage.joints[end->site.joint];
    const double size = vec3_length(at->forces[number].couple);
    joint->gap = fmin(joint->gap, -press->depth);
    joint->moment_on_b += end->sign * coordinate_sense(of) * size;
    joint->force += size;
    joint->is_touching = joint->is_touching || system->contacts[number].mode != CONTACT_APART;
}

static void space_joints(const System *system, const SystemState *state, JointState *joints,
                         SpaceJointState *space_joints)
{
    const Linkage *linkage = &system->scenario->linkage;
    const SpaceState *at = space_state_of(state);
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (joint_is_ideal(linkage->joints[i].kind)) {
            const Vec3 gap = space_tree_gap(&space_dynamics_of(system)->tree, &at->tree, i);
            fill_ideal_joint(&at->reactions[i], gap, &joints[i], &space_joints[i]);
        }
        if (linkage->joints[i].limits.kind != LIMIT_NONE) {
            fill_limited_joint(system, at, i, &joints[i]);
        }
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        const int joint = system->contacts[i].joint;
        if (space_dynamics_of(system)->contacts[i].is_turn) {
            fill_limit(system, at, i, &joints[joint]);
        } else if (i == 0 || system->contacts[i - 1].joint != joint) {
            fill_pin_joint(system, at, i, &joints[joint], &space_joints[joint]);
        }
    }
}

static void space_bodies(const System *system, const SystemState *state, Sample *sample)
{
    space_tree_motions(&space_dynamics_of(system)->tree, &space_state_of(state)->tree,
                       sample->space_bodies);
    for (size_t i = 0; i < system->scenario->linkage.body_count; i++) {
        sample->bodies[i] = space_planar(&sample->space_bodies[i]);
    }
}

static size_t space_rows(const System *system)
{
    return space_dynamics_of(system)->loops->row_count;
}

static SystemState *space_state_create(const System *system)
{
    return &space_dynamics_state_create(space_dynamics_of(system))->shared;
}

static void space_destroy(System *system)
{
    space_dynamics_finish(own_dynamics(system));
    free(system);
}

static const SystemKind SPACE = {
    .state_create = space_state_create,
    .start = space_begin,
    .evaluate = space_evaluate,
    .rates = space_dynamics_rates,
    .slopes = space_slopes,
    .press = space_press,
    .needs = space_needs,
    .sizes = space_sizes,
    .crossing = space_crossing,
    .fastest = space_fastest,
    .peak = space_peak,
    .project = space_project,
    .rebase = space_rebase,
    .time = space_time,
    .since = space_since,
    .turning = space_turning,
    .joints = space_joints,
    .bodies = space_bodies,
    .carry = space_carry,
    .rows = space_rows,
    .destroy = space_destroy,
};

System *space_system_create(const Scenario *scenario, Err *err)
{
    SpaceDynamics *dynamics = zeroed(1, sizeof *dynamics);
    if (!space_dynamics_init(scenario, dynamics, err)) {
        free(dynamics);
        return NULL;
    }
    dynamics->system.kind = &SPACE;
    return &dynamics->system;
}

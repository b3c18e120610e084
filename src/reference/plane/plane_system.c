// Presents the equations of motion in the plane as a system to those who step through them.
#include "reference/plane/dynamics.h"

#include "model/forces.h"
#include "model/scale.h"
#include "reference/plane/articulated.h"
#include "reference/plane/tree.h"
#include "reference/system.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static const Dynamics *plane_dynamics_of(const System *system)
{
    return (const Dynamics *)system;
}

static const DynamicsState *plane_state_of(const SystemState *state)
{
    return (const DynamicsState *)state;
}

// What the linkage has of energy less what it was given, J; its kinetic energy apart.
static double energy_balance(const Dynamics *dynamics, const double *y, double *kinetic)
{
    const System *system = &dynamics->system;
    const Linkage *linkage = dynamics->tree.linkage;
    const double *sums = y + system_sum_index(system, 0);
    const TreeState *state = &dynamics->room.state->tree;
    tree_evaluate(&dynamics->tree, 0.0, y, y + system->coordinate_count,
                  &dynamics->room.state->tree);
    *kinetic = linkage_kinetic_energy(linkage, state->motions);
    double energy =
        *kinetic + forces_energy(linkage, state->motions) +
        linkage_potential_energy(linkage, state->motions, scenario_gravity(system->scenario));
    for (size_t i = 0; i < system->contact_count; i++) {
        if (system->contacts[i].mode != CONTACT_APART) {
            ContactForce force;
            dynamics_contact_find(dynamics, i, state, y, &force);
            energy += force_law_energy(&system->contacts[i].law, force.press.depth);
        }
    }
    energy -= system->has_loads ? sums[system_load_sum(system)] : 0.0;
    return energy - sums[SYSTEM_DRIVE_WORK] + sums[SYSTEM_DISSIPATED] + sums[SYSTEM_FRICTION];
}

// Ideal joints keep the energy; at a change point, where their rows depend on one another, a step
// that has lost its branch does not.
static bool has_gone_astray(Dynamics *dynamics, const double *y)
{
    // a thousand times what a turn through change points costs at the default tolerance
    const double share = fmax(1e-6, 1e4 * dynamics->system.tolerance);
    double kinetic = 0.0;
    const double energy = energy_balance(dynamics, y, &kinetic);
    dynamics->greatest_energy = fmax(dynamics->greatest_energy, kinetic);
    return !(fabs(energy - dynamics->start_energy) <= share * dynamics->greatest_energy +
                                                          1e-9 * fabs(dynamics->start_energy) +
                                                          dynamics->energy_floor);
}

// 1: distance from a change point within which loops are closed before each evaluation. Farther
// away the accelerations of loops that are open by the error of a stage are as smooth as others,
// and steps are of the method's order with them.
static const double NEAR_BRANCH = 0.1;

// Looks where a step begins, whose loops have just been closed.
static void note_branch(Dynamics *dynamics)
{
    dynamics->is_near_branch =
        dynamics->may_branch && !(dynamics->articulated->distance > NEAR_BRANCH);
}

static void plane_start(System *system, double *y)
{
    Dynamics *dynamics = (Dynamics *)system;
    Tree *tree = &dynamics->tree;
    Motion *motions = dynamics->room.state->tree.motions;
    const LoopsRoom room = dynamics_loops(dynamics);
    linkage_start(tree->linkage, motions);
    tree_start(tree, motions, y + tree->coordinate_count);
    loops_start(tree, &room, y, y + tree->coordinate_count);
    note_branch(dynamics);
    if (dynamics->may_branch) {
        dynamics->energy_floor = scale_floor(system->scenario).energy;
        dynamics->start_energy = energy_balance(dynamics, y, &dynamics->greatest_energy);
    }
}

static bool plane_evaluate(const System *system, double since_s, const double *y,
                           SystemState *state, double *rates)
{
    const Dynamics *dynamics = plane_dynamics_of(system);
    DynamicsState *at = (DynamicsState *)state;
    if (rates == NULL || !dynamics->is_near_branch) {
        return dynamics_evaluate(dynamics, since_s, y, at, rates);
    }
    // the rates are those of closed loops, as at every stage
    dynamics_rates(since_s, y, rates, (void *)dynamics);
    return dynamics_evaluate(dynamics, since_s, y, at, NULL);
}

static Press plane_press(const System *system, size_t contact, double since_s, const double *y)
{
    return dynamics_contact(plane_dynamics_of(system), contact, since_s, y).press;
}

static BristleAt plane_bristle(const System *system, size_t bristle, double since_s,
                               const double *y)
{
    return rub_bristle(plane_dynamics_of(system), bristle, since_s, y);
}

static BristleFace plane_face(const System *system, size_t bristle, double since_s, const double *y)
{
    return rub_face(plane_dynamics_of(system), bristle, since_s, y);
}

static void plane_stick(System *system, size_t bristle, const double *y)
{
    rub_stick((Dynamics *)system, bristle, y);
}

static void plane_hold(System *system, double *y)
{
    rub_hold((Dynamics *)system, y);
}

static int plane_jammed(const System *system)
{
    return plane_dynamics_of(system)->rub != NULL ? rub_jammed(plane_dynamics_of(system)) : -1;
}

static DriveTorque plane_torque(const System *system, double since_s, const double *y)
{
    const Dynamics *dynamics = plane_dynamics_of(system);
    const Tree *tree = &dynamics->tree;
    const Linkage *linkage = tree->linkage;
    const Torque *torque = &linkage->torque;
    TreeState *state = &dynamics->room.state->tree;
    tree_evaluate(tree, since_s, y, y + system->coordinate_count, state);
    const double time_s = tree_time(tree, since_s);
    const DriveState to = drive_at(&torque->followed, time_s);
    const JointTurn turn = forces_drive_turn(linkage, state->motions);
    return (DriveTorque){
        .unlimited = forces_drive_unlimited(linkage, state->motions, time_s),
        .terms = torque->stiffness * (fabs(to.angle) + fabs(turn.angle)) +
                 torque->slope * (fabs(to.omega) + fabs(turn.rate)),
    };
}

static WallPlace plane_wall(const System *system, size_t contact, double since_s, const double *y)
{
    return dynamics_contact_wall(plane_dynamics_of(system), contact, since_s, y);
}

static void add_end_size(const Tree *tree, const TreeState *state, int end, double *length,
                         double *speed)
{
    const int body = tree->end_bodies[end];
    *length += vec2_length(tree_end_point(tree, state, end));
    *speed += vec2_length(tree_end_velocity(tree, state, end));
    if (body != LINKAGE_GROUND) {
        const Motion *motion = &state->motions[body];
        const double arm = vec2_length(state->arms[end]);
        // an angle of many turns has fewer digits left for its direction
        *length += arm * (1.0 + fabs(motion->angle));
        *speed += arm * fabs(motion->omega) * (1.0 + fabs(motion->angle));
    }
}

static void plane_sizes(const System *system, const SystemState *state, size_t contact,
                        double *length, double *speed)
{
    const Tree *tree = &plane_dynamics_of(system)->tree;
    const PlaneSite *site = &plane_dynamics_of(system)->sites[contact];
    const int end = 2 * site->pair;
    if (dynamics_contact_is_turn(site)) {
        tree_coordinate_sizes(tree, &plane_state_of(state)->tree, site->touch.joint, length, speed);
        *length += fabs(site->end);
        return;
    }
    add_end_size(tree, &plane_state_of(state)->tree, end, length, speed);
    add_end_size(tree, &plane_state_of(state)->tree, end + 1, length, speed);
    *length += site->touch.half_length;
}

// In a slot across it, and along it as far as that brings the pin to an end.
static double crossing_in_slot(const Tree *tree, const TreeState *state, const PlaneSite *site,
                               double flight)
{
    const TouchSlot slot = touch_in_slot(
        tree_pair_gap(tree, state, site->pair), tree_pair_velocity(tree, state, site->pair),
        tree_normal(tree, state, site->pair), tree_omega(state, tree->end_bodies[2 * site->pair]));
    const double speed = vec2_length(slot.rate);
    const double to_end = fmax(site->touch.half_length - fabs(slot.position.y), flight);
    const double share = flight / to_end;
    const double second = fabs(tree_line_second(tree, state, site->pair)) +
                          share * vec2_length(tree_pair_acceleration(tree, state, site->pair));
    return fabs(slot.rate.x) + share * speed + sqrt(flight * second);
}

// How fast gears may come apart or nearer, m/s.
static double parting_of(const Tree *tree, const TreeState *at, int joint, double flight)
{
    if (tree->linkage->joints[joint].gear.pressure_angle == 0.0) {
        return 0.0;
    }
    const Vec2 offset = tree_pair_gap(tree, at, joint);
    const Vec2 along = vec2_scale(1.0 / vec2_length(offset), offset);
    const Vec2 velocity = tree_pair_velocity(tree, at, joint);
    const double across = vec2_cross(along, velocity);
    const double second = vec2_dot(along, tree_pair_acceleration(tree, at, joint)) +
                          across * across / vec2_length(offset);
    return fabs(vec2_dot(along, velocity)) + sqrt(flight * fabs(second));
}

static double plane_crossing(const System *system, const SystemState *state, size_t contact)
{
    const Dynamics *dynamics = plane_dynamics_of(system);
    const Tree *tree = &dynamics->tree;
    const TreeState *at = &plane_state_of(state)->tree;
    const Contact *of = &system->contacts[contact];
    const PlaneSite *site = &dynamics->sites[contact];
    const int joint = site->touch.joint;
    const int *bodies = tree->end_bodies + 2 * site->pair;
    double passing = 0.0;
    switch (site->touch.shape) {
    case TOUCH_TEETH:
        passing = parting_of(tree, at, joint, of->flight);
        return passing + fabs(tree_coordinate_rate(tree, at, joint)) +
               sqrt(of->flight * fabs(tree_coordinate_second(tree, at, joint)));
    case TOUCH_TURN:
    case TOUCH_RACK:
        return fabs(tree_coordinate_rate(tree, at, joint)) +
               sqrt(of->flight * fabs(tree_coordinate_second(tree, at, joint)));
    case TOUCH_LINE:
        // along the line it may go as fast as it likes
        return fabs(tree_line_rate(tree, at, site->pair)) +
               sqrt(of->flight * fabs(tree_line_second(tree, at, site->pair)));
    case TOUCH_SLOT:
        return crossing_in_slot(tree, at, site, of->flight);
    case TOUCH_CAM:
        // a lobe comes along the profile
        passing = site->touch.cam.profile->reach *
                  fabs(tree_omega(at, bodies[0]) - tree_omega(at, bodies[1]));
        break;
    case TOUCH_HOLE:
    case TOUCH_DISC:
        break;
    }
    const Vec2 v = tree_pair_velocity(tree, at, site->pair);
    const Vec2 a = tree_pair_acceleration(tree, at, site->pair);
    return passing + vec2_length(v) + sqrt(of->flight * vec2_length(a));
}

static double plane_fastest(const System *system, const SystemState *state)
{
    const Dynamics *dynamics = plane_dynamics_of(system);
    const Tree *tree = &dynamics->tree;
    double fastest = 0.0;
    for (size_t i = 0; i < tree->node_count; i++) {
        const int body = tree->nodes[i].body;
        const Motion *motion = &plane_state_of(state)->tree.motions[body];
        const double speed = sqrt(vec2_dot(motion->velocity, motion->velocity));
        fastest = fmax(fastest, speed + fabs(motion->omega) * dynamics->reach[body]);
    }
    return fastest;
}

static void plane_peak(const System *system, const SystemState *state, size_t number,
                       double values[2], double rates[2])
{
    const Dynamics *dynamics = plane_dynamics_of(system);
    const ContactForce *force = &plane_state_of(state)->contacts[number];
    const double second =
        -dynamics_contact_second(dynamics, number, &plane_state_of(state)->tree, &force->pose);
    values[0] = force->press.normal;
    values[1] = force->press.depth;
    rates[0] = press_rate(&system->contacts[number], &force->press, second);
    rates[1] = force->press.closing;
}

static void plane_project(const System *system, double since_s, double *y)
{
    if (plane_dynamics_of(system)->tree.loop_count > 0) {
        const LoopsRoom room = dynamics_loops(plane_dynamics_of(system));
        loops_project(&room, since_s, y, y + system->coordinate_count);
    }
}

static bool plane_rebase(System *system, double since_s, double *y)
{
    Dynamics *dynamics = (Dynamics *)system;
    Tree *tree = &dynamics->tree;
    const double kink_s = linkage_next_kink(tree->linkage, tree_from(tree));
    plane_project(system, since_s, y);
    note_branch(dynamics);
    tree_rebase(tree, since_s, y);
    system->is_astray = dynamics->may_branch && has_gone_astray(dynamics, y);
    // the rates jump at a kink of a drive's speed
    return tree->loop_count > 0 || tree_from(tree) >= kink_s;
}

static void plane_carry(System *system, Carry *carry)
{
    Dynamics *dynamics = (Dynamics *)system;
    carry_bytes(carry, dynamics->tree.memory, dynamics->tree.memory_size);
    CARRY(carry, dynamics->tree.base_time_s);
    for (size_t i = 0; i < dynamics->tree.drive_count; i++) {
        CARRY(carry, dynamics->tree.drives[i].base);
    }
    CARRY(carry, dynamics->is_near_branch);
    CARRY(carry, dynamics->start_energy);
    CARRY(carry, dynamics->greatest_energy);
}

static double plane_time(const System *system, double since_s)
{
    return tree_time(&plane_dynamics_of(system)->tree, since_s);
}

static double plane_since(const System *system, double time_s)
{
    return (double)(time_s - plane_dynamics_of(system)->tree.base_time_s);
}

static void plane_turning(const System *system, const SystemState *state, double *omega,
                          double *alpha)
{
    for (size_t i = 0; i < system->scenario->linkage.body_count; i++) {
        omega[i] = plane_state_of(state)->tree.motions[i].omega;
        alpha[i] = plane_state_of(state)->tree.motions[i].alpha;
    }
}

// Where body b of a prismatic joint or a block is: along and across the line, and how tilted.
static void place_on_line(const Tree *tree, const TreeState *state, int joint, JointState *to)
{
    const Vec2 normal = tree_normal(tree, state, joint);
    const Vec2 gap = tree_pair_gap(tree, state, joint);
    to->eccentricity = (Vec2){vec2_cross(gap, normal), tree_distance(tree, state, joint)};
    to->tilt = tree_tilt(tree, state, joint);
}

// Adds the friction of an ideal joint to what it gives its body b.
static void add_friction(const Tree *tree, const DynamicsState *at, int joint, double friction,
                         JointState *to)
{
    if (tree->measures[joint] != TREE_LINE) {
        to->moment_on_b -= friction;
        return;
    }
    const Vec2 normal = tree_normal(tree, &at->tree, joint);
    to->force_on_b = vec2_sub(to->force_on_b, vec2_scale(friction, (Vec2){normal.y, -normal.x}));
    to->force = vec2_length(to->force_on_b);
}

static void fill_ideal(const Dynamics *dynamics, const DynamicsState *at, int joint, JointState *to)
{
    const Tree *tree = &dynamics->tree;
    const Vec2 a = tree_end_point(tree, &at->tree, 2 * joint);
    const Vec2 b = tree_end_point(tree, &at->tree, 2 * joint + 1);
    *to = (JointState){
        .eccentricity = vec2_sub(b, a),
        .force_on_b = at->reactions[joint],
        .force = sqrt(vec2_dot(at->reactions[joint], at->reactions[joint])),
        .is_touching = true,
    };
    if (tree->measures[joint] == TREE_LINE) {
        place_on_line(tree, &at->tree, joint, to);
        to->moment_on_b = at->couples[joint];
    }
    for (size_t i = 0; i < dynamics->rub_count; i++) {
        if (dynamics->system.bristles[i].joint == joint) {
            add_friction(tree, at, joint, at->rubs[i].friction, to);
        }
    }
}

// A joint whose coordinate is limited before anything presses at its ends. What an ideal joint
// holds stays in the force and moment on its body b; its size is that of what presses.
static void fill_limited(const Dynamics *dynamics, const DynamicsState *at, int joint,
                         JointState *to)
{
    const Joint *of = &dynamics->tree.linkage->joints[joint];
    switch (joint_coordinate(of->kind)) {
    case JOINT_COORDINATE_TEETH:
    case JOINT_COORDINATE_RACK:
        *to = (JointState){.eccentricity = {tree_coordinate(&dynamics->tree, &at->tree, joint), 0}};
        break;
    case JOINT_COORDINATE_ANGLE:
        to->tilt = tree_coordinate_origin(of) + tree_coordinate(&dynamics->tree, &at->tree, joint);
        break;
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_POSITION:
        break;
    }
    to->gap = INFINITY;
    to->force = 0.0;
    to->is_touching = false;
}

// Adds what presses at one end, with its moment about the anchor of body b.
static void plane_add_end(const Touch *place, const ContactForce *end, bool is_touching,
                          JointState *to)
{
    Vec2 from_a = {0.0, 0.0};
    Vec2 from_b = {0.0, 0.0};
    touch_points(place, &end->pose, &from_a, &from_b);
    to->gap = fmin(to->gap, end->pose.gap);
    to->force_on_b = vec2_add(to->force_on_b, end->force);
    to->moment_on_b += end->couple + vec2_cross(from_b, end->force);
    to->force += sqrt(vec2_dot(end->force, end->force)) + fabs(end->couple);
    to->is_touching = to->is_touching || is_touching;
}

// Adds what presses at one of a block's corners.
static void add_corner(const Dynamics *dynamics, const DynamicsState *at, size_t number,
                       JointState *to)
{
    const Tree *tree = &dynamics->tree;
    const ContactForce *corner = &at->contacts[number];
    const int joint = dynamics->sites[number].touch.joint;
    const int pair = dynamics->sites[number].pair;
    Vec2 from_a;
    Vec2 from_b;
    dynamics_contact_points(&dynamics->sites[number], &corner->pose, &from_a, &from_b);
    // from the anchor of body b to the corner
    const Vec2 arm = vec2_sub(vec2_add(tree_end_point(tree, &at->tree, 2 * pair + 1), from_b),
                              tree_end_point(tree, &at->tree, 2 * joint + 1));
    to->gap = fmin(to->gap, corner->pose.gap);
    to->force_on_b = vec2_add(to->force_on_b, corner->force);
    to->force += sqrt(vec2_dot(corner->force, corner->force));
    to->moment_on_b += vec2_cross(arm, corner->force);
    to->is_touching = to->is_touching || dynamics->system.contacts[number].mode != CONTACT_APART;
}

static void plane_joints(const System *system, const SystemState *state, JointState *joints,
                         SpaceJointState *space_joints)
{
    (void)space_joints;
    const Linkage *linkage = &system->scenario->linkage;
    const Dynamics *dynamics = plane_dynamics_of(system);
    const DynamicsState *at = plane_state_of(state);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_is_ideal(linkage->joints[i].kind)) {
            fill_ideal(dynamics, at, (int)i, &joints[i]);
        }
        if (linkage->joints[i].limits.kind != LIMIT_NONE) {
            fill_limited(dynamics, at, (int)i, &joints[i]);
        } else if (joint_has_guides(linkage->joints[i].kind)) {
            joints[i] = (JointState){.gap = INFINITY};
            place_on_line(&dynamics->tree, &at->tree, (int)i, &joints[i]);
        }
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        const ContactForce *force = &at->contacts[i];
        JointState *joint = &joints[system->contacts[i].joint];
        if (joint_has_guides(linkage->joints[system->contacts[i].joint].kind)) {
            add_corner(dynamics, at, i, joint);
            continue;
        }
        if (linkage->joints[system->contacts[i].joint].limits.kind != LIMIT_NONE) {
            plane_add_end(&dynamics->sites[i].touch, force,
                          system->contacts[i].mode != CONTACT_APART, joint);
            continue;
        }
        *joint = (JointState){
            .eccentricity = force->pose.offset,
            .gap = force->pose.gap,
            .force_on_b = force->force,
            .force = sqrt(vec2_dot(force->force, force->force)),
            .is_touching = system->contacts[i].mode != CONTACT_APART,
        };
    }
}

static void plane_bodies(const System *system, const SystemState *state, Sample *sample)
{
    const size_t count = system->scenario->linkage.body_count;
    memcpy(sample->bodies, plane_state_of(state)->tree.motions, count * sizeof *sample->bodies);
}

static bool plane_motions(const System *system, double since_s, const double *y, Sample *sample)
{
    const Dynamics *dynamics = plane_dynamics_of(system);
    if (dynamics->tree.loop_count > 0) {
        return false;
    }
    if (dynamics->hinged != NULL && tree_is_steady(&dynamics->tree)) {
        hinged_motions(dynamics->hinged, since_s, y, sample->bodies);
        return true;
    }
    DynamicsState *at = dynamics->room.state;
    tree_evaluate(&dynamics->tree, since_s, y, y + system->coordinate_count, &at->tree);
    plane_bodies(system, &at->shared, sample);
    return true;
}

static size_t plane_rows(const System *system)
{
    return 2 * plane_dynamics_of(system)->tree.loop_count;
}

static SystemState *plane_state_create(const System *system)
{
    return &dynamics_state_create(plane_dynamics_of(system))->shared;
}

static void plane_destroy(System *system)
{
    dynamics_finish((Dynamics *)system);
    free(system);
}

static const SystemKind PLANE = {
    .state_create = plane_state_create,
    .start = plane_start,
    .evaluate = plane_evaluate,
    .rates = dynamics_rates,
    .slopes = dynamics_slopes,
    .press = plane_press,
    .bristle = plane_bristle,
    .face = plane_face,
    .stick = plane_stick,
    .hold = plane_hold,
    .jammed = plane_jammed,
    .wall = plane_wall,
    .torque = plane_torque,
    .needs = dynamics_contact_needs,
    .sizes = plane_sizes,
    .crossing = plane_crossing,
    .fastest = plane_fastest,
    .peak = plane_peak,
    .project = plane_project,
    .rebase = plane_rebase,
    .time = plane_time,
    .since = plane_since,
    .turning = plane_turning,
    .joints = plane_joints,
    .bodies = plane_bodies,
    .motions = plane_motions,
    .carry = plane_carry,
    .rows = plane_rows,
    .destroy = plane_destroy,
};

System *plane_system_create(const Scenario *scenario, Err *err)
{
    Dynamics *dynamics = malloc(sizeof *dynamics);
    assert(dynamics != NULL);
    if (!dynamics_init(scenario, dynamics, err)) {
        free(dynamics);
        return NULL;
    }
    dynamics->system.kind = &PLANE;
    return &dynamics->system;
}

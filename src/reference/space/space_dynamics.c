// Finds the accelerations of a linkage with play in space.
//
//     M qdd = sum over bodies  B' (F - m a_bias) + W' (N - I al_bias - w x I w) + J' lambda
//     J qdd = gamma,           M = sum  m B' B + W' I W
// B, W: velocity of each centre and angular velocity of each body by each coordinate
// (reference/space/space_tree.h); J, gamma: the joints that close loops
// (reference/space/space_articulated.h); F, N: gravity and the contacts (see below), N about the
// centre. The drive's power is that of what is missing from the equations of all that turns with
// it, along its axis.
#include "reference/space/space_dynamics.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "kernel/friction_law.h"
#include "model/space_coordinate.h"

#include <math.h>
#include <string.h>

// Limited angles: the torque with which flanks or stops press on a hinge in space.
//
// The angle counts from the base, where it has the digits of a long double: with u the axis on body
// a, s_a and s_b a direction across it that both bodies carry and that is one at the base,
//     q = q_base +- atan2(u . (s_a x (s_b - s_a)), s_a . s_b),   q' = +- u . (w_b - w_a)
// and a penetration of s (q_end - q), s = 1 at the low end and -1 at the high one, is pressed back
// by a torque s N along q on body b and the other way on body a.

static Vec3 axis_of(const SpaceTree *tree, const SpaceTreeState *state, int joint)
{
    return vec3_scale(coordinate_sense(&tree->linkage->joints[joint]),
                      space_tree_axis(tree, state, 2 * joint));
}

double space_turn_angle(const SpaceTree *tree, const SpaceTreeState *state, int joint)
{
    const Vec3 side = vec3_normal_to(tree->base_axes[2 * joint]);
    const Vec3 a = mat3_apply(&space_tree_body(state, tree->ends[2 * joint].body)->turned, side);
    const Vec3 b =
        mat3_apply(&space_tree_body(state, tree->ends[2 * joint + 1].body)->turned, side);
    const Vec3 at_a = vec3_add(side, a);
    const double sine = vec3_dot(axis_of(tree, state, joint), vec3_cross(at_a, vec3_sub(b, a)));
    return tree->base_coordinates[joint] + atan2(sine, vec3_dot(at_a, vec3_add(side, b)));
}

double space_turn_rate(const SpaceTree *tree, const SpaceTreeState *state, int joint)
{
    const SpaceBodyState *a = space_tree_body(state, tree->ends[2 * joint].body);
    const SpaceBodyState *b = space_tree_body(state, tree->ends[2 * joint + 1].body);
    return vec3_dot(axis_of(tree, state, joint), vec3_sub(b->omega, a->omega));
}

double space_turn_second(const SpaceTree *tree, const SpaceTreeState *state, int joint)
{
    const SpaceBodyState *a = space_tree_body(state, tree->ends[2 * joint].body);
    const SpaceBodyState *b = space_tree_body(state, tree->ends[2 * joint + 1].body);
    // what the axis turns by is across it, and so is nothing of the bodies' turning about it
    return vec3_dot(axis_of(tree, state, joint), vec3_sub(b->alpha, a->alpha));
}

// What an end presses with.
static void space_turn_find(const SpaceContact *at, const Contact *contact, const SpaceTree *tree,
                            const SpaceTreeState *state, SpaceForce *force)
{
    const int joint = at->site.joint;
    const Vec3 none = {0.0, 0.0, 0.0};
    force->force = force->couple = none;
    force->press =
        press_find(contact, at->sign * (at->limit - space_turn_angle(tree, state, joint)),
                   -at->sign * space_turn_rate(tree, state, joint));
    if (contact->mode == CONTACT_PRESSING) {
        force->couple = vec3_scale(at->sign * force->press.normal, axis_of(tree, state, joint));
    }
}

// m: the lever of the angle, the shorter of how far its bodies reach.
static double space_turn_arm_of(const SpaceTree *tree, int joint)
{
    double arm = INFINITY;
    for (int side = 0; side < 2; side++) {
        const int body = tree->ends[2 * joint + side].body;
        arm = body == LINKAGE_GROUND ? arm : fmin(arm, tree->reaches[body]);
    }
    return arm;
}

// The ends of a limited angle as contacts: which they are of a
// joint, each with its law; how many. The pose and the rest are found by the functions below.
static size_t space_turn_list(const Scenario *scenario, const SpaceTree *tree, int joint,
                              SpaceContact *contacts, Contact *laws, Err *err)
{
    const Joint *of = &scenario->linkage.joints[joint];
    const double ends[2] = {coordinate_low(of), coordinate_high(of)};
    ForceLaw law;
    if (!law_of_joint(scenario, of, &law, err)) {
        return 0;
    }
    size_t count = 0;
    for (int i = 0; i < 2; i++) {
        if (isfinite(ends[i])) {
            contacts[count] = (SpaceContact){
                .site = {.joint = joint, .hole = {.body = of->body_a}, .pin = {.body = of->body_b}},
                .is_turn = true,
                .sign = i == 0 ? 1.0 : -1.0,
                .limit = ends[i],
            };
            const double play = coordinate_play(of);
            laws[count++] = (Contact){
                .joint = joint,
                .place = i, // as stop_space_place has it
                .law = law,
                .arm = space_turn_arm_of(tree, joint),
                .flight = isfinite(play) ? play : 1.0,
            };
        }
    }
    if (count == 2) {
        laws[0].partner = 1;
        laws[1].partner = -1;
    }
    return count;
}

// Contact forces: the force with which a pin in space presses on a contact site of its hole.
//
// The model is that of contact/pin_space.h, its numbers count from the base: with g the
// pin's point less the hole's, u the axis of the pin (of a collar: of the hole)
//     an end:    e = g - (u . g) u,   P = pin's point - (u . g) u
//     a collar:  e = (u . g) u,       P = the pin's middle
// and d = |e| - c. Friction acts at the wall's point nearest to the pin, on both bodies, against
// what slides there across the normal, along the wall and along the axis:
//     mu N tanh(|v| / v_s) v / |v|
// A collar has none.
//
// For the maxima of force and depth: with w the velocity of body b less that of body a at P, and
// s' the speed of P along the pin's axis, s' = -u . w - u' . e, u' = w_b x u,
//     d'' = (w . w + s' u . w - d'^2) / |e| + n . (a_b(P) - a_a(O)) + s' n . u',   n = e / |e|
// and of a collar  d'' = n . (a_b(M) - a_a(M)) + 2 (w_a x n) . w.

void space_contact_rebase(const SpaceTree *tree, SpaceContact *contact)
{
    const PinSpace *site = &contact->site;
    const SpaceEnd *hole = &site->hole;
    const SpaceEnd *pin = &site->pin;
    const LongVec3 hole_arm = space_tree_base_arm(tree, hole->body, hole->anchor);
    LongVec3 pin_arm = space_tree_base_arm(tree, pin->body, pin->anchor);
    const LongVec3 from = space_tree_base_point(tree, hole->body, hole->anchor);
    const LongVec3 to = space_tree_base_point(tree, pin->body, pin->anchor);
    LongVec3 gap = long_vec3_add(to, long_vec3_scale(-1.0L, from));
    const bool is_collar = site->place == PIN_SPACE_COLLAR;
    const SpaceEnd *along = is_collar ? hole : pin;
    const LongVec3 axis = space_tree_base_arm(tree, along->body, along->axis);
    if (!is_collar) {
        const long double share = long_vec3_dot(axis, gap) / long_vec3_dot(axis, axis);
        const LongVec3 back = long_vec3_scale(-share, axis);
        pin_arm = long_vec3_add(pin_arm, back);
        gap = long_vec3_add(gap, back);
    }
    contact->base_hole = long_vec3_round(hole_arm);
    contact->base_pin = long_vec3_round(pin_arm);
    contact->base_gap = long_vec3_round(gap);
    contact->base_axis = long_vec3_round(axis);
    contact->base_axis = vec3_scale(1.0 / vec3_length(contact->base_axis), contact->base_axis);
}

// Offset, axis and the points of both bodies at which the force acts.
static void find_pose(const SpaceContact *at, const SpaceTreeState *state, SpaceForce *force)
{
    const int a = at->site.hole.body;
    const int b = at->site.pin.body;
    const bool is_collar = at->site.place == PIN_SPACE_COLLAR;
    const SpaceBodyState *body_a = space_tree_body(state, a);
    const SpaceBodyState *body_b = space_tree_body(state, b);
    const Vec3 turned_a = mat3_apply(&body_a->turned, at->base_hole);
    const Vec3 turned_b = mat3_apply(&body_b->turned, at->base_pin);
    const Vec3 moved =
        vec3_sub(vec3_add(body_b->moved, turned_b), vec3_add(body_a->moved, turned_a));
    const Vec3 gap = vec3_add(at->base_gap, moved);
    force->axis = space_tree_direction(state, is_collar ? a : b, at->base_axis);
    const Vec3 along = vec3_scale(vec3_dot(force->axis, gap), force->axis);
    force->from_a = vec3_add(at->base_hole, turned_a);
    force->from_b = vec3_add(at->base_pin, turned_b);
    if (is_collar) {
        force->offset = along;
        force->from_a = vec3_add(force->from_a, gap);
    } else {
        force->offset = vec3_sub(gap, along);
        force->from_b = vec3_sub(force->from_b, along);
    }
    force->relative = vec3_sub(space_tree_velocity(state, b, force->from_b),
                               space_tree_velocity(state, a, force->from_a));
}

// Adds what friction does to an end that presses.
static void space_contact_add_friction(const SpaceContact *at, const Contact *contact,
                                       const SpaceTreeState *state, SpaceForce *force)
{
    const Vec3 wall = vec3_scale(contact->hole_radius, force->outward);
    force->force_a = vec3_add(force->from_a, wall);
    force->force_b = vec3_add(force->from_b, vec3_sub(wall, force->offset));
    const Vec3 sliding =
        vec3_across(vec3_sub(space_tree_velocity(state, at->site.pin.body, force->force_b),
                             space_tree_velocity(state, at->site.hole.body, force->force_a)),
                    force->outward);
    const double speed = vec3_length(sliding);
    const double share = friction_grip(speed, contact->law.friction_speed).share;
    const double friction = contact->law.friction * force->press.normal * share;
    force->force = vec3_sub(force->force, vec3_scale(friction, sliding));
    force->press.friction_power = friction * speed * speed;
}

// A site's quantities from the state of the tree. The mode is that of `contact`, the law's.
static void space_contact_find(const SpaceContact *at, const Contact *contact,
                               const SpaceTreeState *state, SpaceForce *force)
{
    find_pose(at, state, force);
    force->size = sqrt(vec3_dot(force->offset, force->offset));
    force->force = (Vec3){0.0, 0.0, 0.0};
    double closing = 0.0;
    if (force->size > 0.0) {
        force->outward = vec3_scale(1.0 / force->size, force->offset);
        closing = vec3_dot(force->outward, force->relative);
    } else {
        // a centred pin moves towards its wall, whichever way it goes
        force->outward = (Vec3){0.0, 0.0, 0.0};
        closing = contact->is_collar ? fabs(vec3_dot(force->axis, force->relative))
                                     : vec3_length(vec3_across(force->relative, force->axis));
    }
    force->press = press_find(contact, force->size - contact->clearance, closing);
    if (contact->mode != CONTACT_PRESSING) {
        return;
    }
    force->force = vec3_scale(-force->press.normal, force->outward);
    force->force_a = force->from_a;
    force->force_b = force->from_b;
    if (contact->law.friction > 0.0 && !contact->is_collar) {
        space_contact_add_friction(at, contact, state, force);
    }
}

double space_contact_second(const SpaceContact *at, const SpaceTreeState *state,
                            const SpaceForce *force)
{
    const int a = at->site.hole.body;
    const int b = at->site.pin.body;
    const Vec3 outward = force->outward;
    const Vec3 w = force->relative;
    const Vec3 changing = vec3_sub(space_tree_acceleration(state, b, force->from_b),
                                   space_tree_acceleration(state, a, force->from_a));
    const double pushed = vec3_dot(outward, changing);
    if (at->site.place == PIN_SPACE_COLLAR) {
        const Vec3 turning = vec3_cross(space_tree_body(state, a)->omega, outward);
        return pushed + 2.0 * vec3_dot(turning, w);
    }
    const Vec3 swing = vec3_cross(space_tree_body(state, b)->omega, force->axis);
    const double sliding = vec3_dot(force->axis, w);
    const double along = -sliding - vec3_dot(swing, force->offset);
    const double closing = force->press.closing;
    return (vec3_dot(w, w) + along * sliding - closing * closing) / force->size + pushed +
           along * vec3_dot(outward, swing);
}

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
static void space_dynamics_start_loads(const SpaceDynamics *dynamics)
{
    const Linkage *linkage = dynamics->tree.linkage;
    const Vec3 none = {0.0, 0.0, 0.0};
    dynamics->loads[0] = (SpacePush){none, none};
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Vec3 gravity = dynamics->system.scenario->gravity;
        dynamics->loads[i + 1] = (SpacePush){vec3_scale(linkage->bodies[i].mass, gravity), none};
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
        const Vec3 bias_moment = vec3_add(mat3_apply(&inertia, at->spin_bias),
                                          vec3_cross(at->omega, mat3_apply(&inertia, at->omega)));
        const double mass = tree->linkage->bodies[body].mass;
        const SpacePush *load = &dynamics->loads[body + 1];
        dynamics->pushes[body] = (SpacePush){
            .force = vec3_sub(load->force, vec3_scale(mass, at->bias)),
            .moment = vec3_sub(load->moment, bias_moment),
        };
    }
}

// What the loops' rows ask of the second rates.
static void find_sides(const SpaceDynamics *dynamics, const SpaceTreeState *state)
{
    const SpaceLoops *loops = dynamics->loops;
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        dynamics->sides[i] =
            loops->rows[i].is_active
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
        if (!loops->rows[i].is_active) {
            continue;
        }
        const int joint = loops->joints[i / SPACE_JOINT_ROWS];
        const int end = 2 * joint;
        const int a = tree->ends[end].body;
        const int b = tree->ends[end + 1].body;
        const Vec3 reaction = vec3_scale(-lambda[i], loops->rows[i].direction);
        if (i % SPACE_JOINT_ROWS < SPACE_POINT_ROWS) {
            load_body(dynamics->loads, b, state->tree.arms[end + 1], reaction);
            load_body(dynamics->loads, a, state->tree.arms[end], vec3_scale(-1.0, reaction));
            state->reactions[joint] = vec3_add(state->reactions[joint], reaction);
        } else {
            load_moment(dynamics->loads, b, reaction);
            load_moment(dynamics->loads, a, vec3_scale(-1.0, reaction));
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
static void space_dynamics_find_drive(const SpaceDynamics *dynamics, SpaceState *state)
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
        const Vec3 reaction = force_missing(tree, &state->tree, loads, node->body);
        const bool is_child_b = tree->linkage->joints[node->joint].body_b == node->body;
        state->reactions[node->joint] = vec3_scale(is_child_b ? 1.0 : -1.0, reaction);
        loads[node->parent + 1].force = vec3_sub(loads[node->parent + 1].force, reaction);
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
    space_dynamics_start_loads(dynamics);
    for (size_t i = 0; i < system->contact_count; i++) {
        const SpaceContact *contact = &dynamics->contacts[i];
        SpaceForce *force = &state->forces[i];
        find_force(dynamics, i, state);
        if (contact->is_turn) {
            load_moment(dynamics->loads, contact->site.pin.body, force->couple);
            load_moment(dynamics->loads, contact->site.hole.body, vec3_scale(-1.0, force->couple));
        } else if (system->contacts[i].mode == CONTACT_PRESSING) {
            load_body(dynamics->loads, contact->site.pin.body, force->force_b, force->force);
            load_body(dynamics->loads, contact->site.hole.body, force->force_a,
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
static bool space_dynamics_find_rates(const SpaceDynamics *dynamics, double since_s,
                                      const double *y, SpaceState *state)
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

static void space_dynamics_fill_sums(const SpaceDynamics *dynamics, const SpaceState *state,
                                     double *sums)
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
static void space_dynamics_fill_rates(const SpaceDynamics *dynamics, const SpaceState *state,
                                      const double *y, double *rates)
{
    const size_t n = dynamics->tree.coordinate_count;
    for (size_t i = 0; i < n; i++) {
        rates[i] = y[n + i];
        rates[n + i] = dynamics->solved[i];
    }
    space_dynamics_fill_sums(dynamics, state, rates + 2 * n);
}

bool space_dynamics_evaluate(const SpaceDynamics *dynamics, double since_s, const double *y,
                             SpaceState *state, double *rates)
{
    if (!space_dynamics_find_rates(dynamics, since_s, y, state)) {
        return false;
    }
    space_tree_accelerate(&dynamics->tree, dynamics->solved, &state->tree);
    load_loops(dynamics, state);
    space_dynamics_find_drive(dynamics, state);
    find_reactions(&dynamics->tree, dynamics->loads, state);
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        state->shared.contacts[i] = state->forces[i].press;
    }
    if (rates != NULL) {
        space_dynamics_fill_rates(dynamics, state, y, rates);
    }
    return true;
}

Press space_dynamics_press(const SpaceDynamics *dynamics, size_t contact, double since_s,
                           const double *y)
{
    const size_t n = dynamics->tree.coordinate_count;
    SpaceState *state = dynamics->scratch;
    const PinSpace *site = &dynamics->contacts[contact].site;
    space_tree_evaluate_pair(&dynamics->tree, site->hole.body, site->pin.body, since_s, y, y + n,
                             &state->tree);
    find_force(dynamics, contact, state);
    return state->forces[contact].press;
}

void space_dynamics_rates(double since_s, const double *y, double *rates, void *context)
{
    const SpaceDynamics *dynamics = context;
    SpaceState *state = dynamics->scratch;
    if (!space_dynamics_find_rates(dynamics, since_s, y, state)) {
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
    space_dynamics_find_drive(dynamics, state);
    space_dynamics_fill_rates(dynamics, state, y, rates);
}

// Building: what the equations of motion in space need, and of which size.

// What the coordinates of the tree are.
static void space_dynamics_list_coordinates(SpaceDynamics *dynamics)
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

static void space_dynamics_set_pins(SpaceDynamics *dynamics, const PinSpace *sites, size_t count)
{
    System *system = &dynamics->system;
    system->contact_count = count;
    for (size_t i = 0; i < count; i++) {
        const Joint *joint = &system->scenario->linkage.joints[sites[i].joint];
        dynamics->contacts[i].site = sites[i];
        system->contacts[i] = (Contact){
            .joint = sites[i].joint,
            .place = sites[i].place,
            .law = sites[i].law,
            .clearance = sites[i].clearance,
            .arm = 1.0,
            .flight = sites[i].clearance,
            .hole_radius = joint->clearance.hole_radius,
            .is_collar = sites[i].place == PIN_SPACE_COLLAR,
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

static Coupling *space_dynamics_couple(const SpaceDynamics *dynamics)
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
    PinSpace *sites = pin_space_list(scenario, &count, err);
    if (sites == NULL) {
        return false;
    }
    *dynamics = (SpaceDynamics){.system = {.scenario = scenario,
                                           .tolerance = law_reference_tolerance(scenario),
                                           .torn = -1}};
    System *system = &dynamics->system;
    SpaceTree *tree = &dynamics->tree;
    space_tree_build(linkage, tree);
    dynamics->loops = space_loops_create(tree, tree->loop_count, tree->loops);
    system->coordinates = zeroed(tree->coordinate_count, sizeof *system->coordinates);
    space_dynamics_list_coordinates(dynamics);
    system->coupling = space_dynamics_couple(dynamics);
    const size_t most = count + 2 * linkage->joint_count;
    system->contacts = zeroed(most, sizeof *system->contacts);
    dynamics->contacts = zeroed(most, sizeof *dynamics->contacts);
    space_dynamics_set_pins(dynamics, sites, count);
    free(sites);
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
static SpaceState *space_dynamics_lay_state(const SpaceDynamics *dynamics, MemoryLayout *layout)
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
    MemoryLayout layout = {NULL, 0};
    space_dynamics_lay_state(dynamics, &layout);
    return space_dynamics_lay_state(dynamics, &(MemoryLayout){zeroed(layout.used, 1), 0});
}

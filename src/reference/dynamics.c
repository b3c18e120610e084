// How does a linkage with play accelerate?
//
//     M qdd = sum over bodies B^T (F - m a_bias) + moments + J^T lambda,   J qdd = gamma
// B: velocity of each centre by each coordinate (reference/tree.h), M = sum m B^T B + I; J, gamma:
// the joints that close loops. A contact presses its pin with N along the normal, from the law:
//     N = F_el(d) (1 + chi d'/v0) + c d'        (never below zero: the slack mode)
// and holds it back with mu N tanh(v_t / v_s) along the wall, at the wall's nearest point, v_t the
// sliding speed of the two bodies there. tanh makes Coulomb's law smooth.
#include "reference/dynamics.h"

#include "base/dense.h"
#include "contact/law.h"
#include "reference/loops.h"

#include <string.h>

enum { EQUATION_MAX = TREE_COORDINATE_MAX + 2 * TREE_LOOP_MAX };

// Forces on the bodies, by body: at the centre, and the moment about it.
typedef struct Loads {
    Vec2 force[LINKAGE_BODY_MAX];
    double moment[LINKAGE_BODY_MAX];
    double driven_power; // W, of all forces on the driven body but the drive's
    Vec2 driven_force;   // N, their sum
} Loads;

size_t dynamics_sum_index(const Dynamics *dynamics, size_t sum)
{
    return 2 * dynamics->tree.coordinate_count + sum;
}

size_t dynamics_size(const Dynamics *dynamics)
{
    return dynamics_sum_index(dynamics, DYNAMICS_IMPULSES) + dynamics->contact_count;
}

bool dynamics_init(const Scenario *scenario, Dynamics *dynamics, Err *err)
{
    *dynamics = (Dynamics){.scenario = scenario};
    tree_build(&scenario->linkage, &dynamics->tree);
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (joint->kind != JOINT_CLEARANCE) {
            continue;
        }
        DynamicsContact *contact = &dynamics->contacts[dynamics->contact_count++];
        contact->joint = (int)i;
        contact->radial_clearance = linkage_radial_clearance(joint);
        contact->hole_radius = joint->clearance.hole_radius;
        if (!law_build(&scenario->contact, &scenario->material, &joint->clearance,
                       scenario->linkage.driver.speed, &contact->law, err)) {
            err_prefix(err, joint->name);
            return false;
        }
    }
    return true;
}

static PinHole contact_pose(const Dynamics *dynamics, size_t number, const TreeState *tree)
{
    const DynamicsContact *contact = &dynamics->contacts[number];
    const int hole = 2 * contact->joint;
    const int pin = hole + 1;
    const Vec2 moving = vec2_sub(tree_end_velocity(&dynamics->tree, tree, pin),
                                 tree_end_velocity(&dynamics->tree, tree, hole));
    return pin_hole_pose(tree_end_point(&dynamics->tree, tree, hole),
                         tree_end_point(&dynamics->tree, tree, pin), moving,
                         contact->radial_clearance);
}

static Vec2 body_centre(const TreeState *tree, int body)
{
    return body == LINKAGE_GROUND ? (Vec2){0.0, 0.0} : tree->motions[body].position;
}

static Vec2 velocity_at(const TreeState *tree, int body, Vec2 point)
{
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Vec2 arm = vec2_sub(point, body_centre(tree, body));
    return vec2_add(tree->motions[body].velocity,
                    vec2_scale(tree->motions[body].omega, vec2_perp(arm)));
}

// Adds what friction does to a contact that presses.
static void add_friction(const Dynamics *dynamics, const DynamicsContact *contact,
                         const TreeState *tree, ContactForce *force)
{
    const ContactOptions *options = &dynamics->scenario->contact;
    const Joint *joint = &dynamics->scenario->linkage.joints[contact->joint];
    const Vec2 hole = tree_end_point(&dynamics->tree, tree, 2 * contact->joint);
    const Vec2 point = pin_hole_contact_point(&force->pose, hole, contact->hole_radius);
    const Vec2 tangent = vec2_perp(force->pose.normal);
    const Vec2 sliding =
        vec2_sub(velocity_at(tree, joint->body_b, point), velocity_at(tree, joint->body_a, point));
    const double speed = vec2_dot(tangent, sliding);
    const double held = options->friction * force->normal * tanh(speed / options->friction_speed);
    force->force = vec2_sub(force->force, vec2_scale(held, tangent));
    force->friction_power = held * speed;
}

static void find_contact(const Dynamics *dynamics, size_t number, const TreeState *tree,
                         ContactForce *force)
{
    const DynamicsContact *contact = &dynamics->contacts[number];
    const ForceLaw *law = &contact->law;
    *force = (ContactForce){.pose = contact_pose(dynamics, number, tree)};
    if (contact->mode == CONTACT_APART) {
        return;
    }
    // odd below zero depth: a step that overshoots the end of a contact stays smooth
    const double depth = force->pose.penetration;
    const double closing = force->pose.approach_speed;
    force->elastic = copysign(force_law_elastic(law, fabs(depth)), depth);
    const double rise = 1.0 + contact->damping_rate * closing;
    force->pressing = force->elastic * rise + law->viscous * closing;
    force->release = law->viscous > 0.0 ? force->pressing : rise;
    // a slack spring relaxes by itself: what it had stored is lost like the damper's work
    force->normal = contact->mode == CONTACT_PRESSING ? force->pressing : 0.0;
    force->damping_power = (force->normal - force->elastic) * closing;
    if (contact->mode == CONTACT_SLACK) {
        return;
    }
    force->force = vec2_scale(force->normal, force->pose.normal);
    if (dynamics->scenario->contact.friction > 0.0) {
        add_friction(dynamics, contact, tree, force);
    }
}

// A force on a body at a point of the world.
static void load_body(const Dynamics *dynamics, const TreeState *tree, int body, Vec2 point,
                      Vec2 force, Loads *loads)
{
    if (body == LINKAGE_GROUND) {
        return;
    }
    if (body == dynamics->tree.driven) {
        loads->driven_power += vec2_dot(force, velocity_at(tree, body, point));
        loads->driven_force = vec2_add(loads->driven_force, force);
        return;
    }
    const Vec2 arm = vec2_sub(point, body_centre(tree, body));
    loads->force[body] = vec2_add(loads->force[body], force);
    loads->moment[body] += vec2_cross(arm, force);
}

static void load_contact(const Dynamics *dynamics, size_t number, const TreeState *tree,
                         const ContactForce *force, Loads *loads)
{
    const DynamicsContact *contact = &dynamics->contacts[number];
    const Joint *joint = &dynamics->scenario->linkage.joints[contact->joint];
    const Vec2 hole = tree_end_point(&dynamics->tree, tree, 2 * contact->joint);
    // without friction the force's line passes through both centres; the pin's keeps its digits
    const bool is_rough = dynamics->scenario->contact.friction > 0.0;
    const Vec2 point =
        is_rough ? pin_hole_contact_point(&force->pose, hole, contact->hole_radius) : hole;
    load_body(dynamics, tree, joint->body_b, point, force->force, loads);
    load_body(dynamics, tree, joint->body_a, point, vec2_scale(-1.0, force->force), loads);
}

static void load_gravity(const Dynamics *dynamics, Loads *loads)
{
    const Tree *tree = &dynamics->tree;
    for (size_t i = 0; i < tree->node_count; i++) {
        const int body = tree->nodes[i].body;
        const double weight = tree->linkage->bodies[body].mass * dynamics->scenario->gravity;
        loads->force[body] = vec2_sub(loads->force[body], (Vec2){0.0, weight});
    }
}

// Mass matrix (n by n, in rows of `width`) and right-hand side of the coordinates.
static void assemble(const Tree *tree, const TreeState *state, const Loads *loads, size_t width,
                     double *matrix, double *right)
{
    const size_t n = tree->coordinate_count;
    for (size_t i = 0; i < tree->node_count; i++) {
        const int body = tree->nodes[i].body;
        const double mass = tree->linkage->bodies[body].mass;
        const Vec2 *columns = state->columns[body];
        const Vec2 push = vec2_sub(loads->force[body], vec2_scale(mass, state->bias[body]));
        for (size_t j = 0; j < n; j++) {
            right[j] += vec2_dot(columns[j], push);
            for (size_t k = 0; k < n; k++) {
                matrix[j * width + k] += mass * vec2_dot(columns[j], columns[k]);
            }
        }
        const size_t angle = tree->nodes[i].angle_column;
        matrix[angle * width + angle] += tree->linkage->bodies[body].inertia;
        right[angle] += loads->moment[body];
    }
}

static void append_loops(const Tree *tree, const TreeState *state, size_t width, double *matrix,
                         double *right)
{
    const size_t n = tree->coordinate_count;
    Vec2 row[TREE_COORDINATE_MAX];
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        const int end = 2 * tree->loops[loop];
        const Vec2 gamma =
            vec2_sub(tree_end_bias(tree, state, end), tree_end_bias(tree, state, end + 1));
        const size_t x = n + 2 * loop;
        loops_row(tree, state, loop, row);
        for (size_t j = 0; j < n; j++) {
            matrix[x * width + j] = matrix[j * width + x] = row[j].x;
            matrix[(x + 1) * width + j] = matrix[j * width + x + 1] = row[j].y;
        }
        right[x] = gamma.x;
        right[x + 1] = gamma.y;
    }
}

// Forces of the loop joints on their bodies b: the multipliers' negatives.
static void load_loops(const Dynamics *dynamics, const TreeState *state, const double *solved,
                       Vec2 *reactions, Loads *loads)
{
    const Tree *tree = &dynamics->tree;
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        const Joint *joint = &tree->linkage->joints[tree->loops[loop]];
        const double *lambda = solved + tree->coordinate_count + 2 * loop;
        const Vec2 force = {-lambda[0], -lambda[1]};
        const Vec2 point = tree_end_point(tree, state, 2 * tree->loops[loop]);
        reactions[tree->loops[loop]] = force;
        load_body(dynamics, state, joint->body_b, point, force, loads);
        load_body(dynamics, state, joint->body_a, point, vec2_scale(-1.0, force), loads);
    }
}

// Reactions of the tree's joints, children before parents, from each body's own equation.
static void find_reactions(const Dynamics *dynamics, const TreeState *state, Loads *loads,
                           Vec2 *reactions)
{
    const Tree *tree = &dynamics->tree;
    for (size_t i = tree->node_count; i-- > 0;) {
        const TreeNode *node = &tree->nodes[i];
        if (node->joint < 0) {
            continue;
        }
        const double mass = tree->linkage->bodies[node->body].mass;
        const Vec2 held = vec2_sub(vec2_scale(mass, state->motions[node->body].acceleration),
                                   loads->force[node->body]);
        const bool is_child_b = tree->linkage->joints[node->joint].body_b == node->body;
        reactions[node->joint] = is_child_b ? held : vec2_scale(-1.0, held);
        load_body(dynamics, state, node->parent, tree_end_point(tree, state, node->parent_end),
                  vec2_scale(-1.0, held), loads);
    }
}

// Power of the drive and force of the driven joint, from the driven body's own equations.
static void find_drive(const Dynamics *dynamics, const Loads *loads, DynamicsState *state)
{
    const Tree *tree = &dynamics->tree;
    state->drive_power = 0.0;
    if (tree->driven < 0) {
        return;
    }
    const double mass = tree->linkage->bodies[tree->driven].mass;
    const Motion *motion = &state->tree.motions[tree->driven];
    const Vec2 needed =
        vec2_scale(mass, vec2_add(motion->acceleration, (Vec2){0.0, dynamics->scenario->gravity}));
    state->drive_power = vec2_dot(needed, motion->velocity) - loads->driven_power;
    state->reactions[tree->linkage->driver.joint] = vec2_sub(needed, loads->driven_force);
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

// Everything at an instant; the reactions of the tree's joints only if asked for, or where the
// driven body carries some and the drive's power depends on them.
static bool evaluate(const Dynamics *dynamics, double time_s, const double *y, bool with_reactions,
                     DynamicsState *state)
{
    const Tree *tree = &dynamics->tree;
    const size_t n = tree->coordinate_count;
    const size_t width = n + 2 * tree->loop_count;
    double matrix[EQUATION_MAX * EQUATION_MAX];
    double right[EQUATION_MAX];
    Loads loads;
    memset(loads.force, 0, tree->linkage->body_count * sizeof *loads.force);
    memset(loads.moment, 0, tree->linkage->body_count * sizeof *loads.moment);
    loads.driven_power = 0.0;
    loads.driven_force = (Vec2){0.0, 0.0};
    memset(matrix, 0, width * width * sizeof *matrix);
    memset(right, 0, width * sizeof *right);

    tree_evaluate(tree, time_s, y, y + n, &state->tree);
    load_gravity(dynamics, &loads);
    for (size_t i = 0; i < dynamics->contact_count; i++) {
        find_contact(dynamics, i, &state->tree, &state->contacts[i]);
        if (dynamics->contacts[i].mode == CONTACT_PRESSING) {
            load_contact(dynamics, i, &state->tree, &state->contacts[i], &loads);
        }
    }
    assemble(tree, &state->tree, &loads, width, matrix, right);
    append_loops(tree, &state->tree, width, matrix, right);
    if (!solve(width, matrix, right)) {
        return false;
    }
    tree_accelerate(tree, right, &state->tree);
    load_loops(dynamics, &state->tree, right, state->reactions, &loads);
    if (with_reactions || tree->is_driven_hung_on) {
        find_reactions(dynamics, &state->tree, &loads, state->reactions);
    }
    find_drive(dynamics, &loads, state);
    return true;
}

bool dynamics_evaluate(const Dynamics *dynamics, double time_s, const double *y,
                       DynamicsState *state)
{
    return evaluate(dynamics, time_s, y, true, state);
}

void dynamics_rates(double time_s, const double *y, double *rates, void *context)
{
    const Dynamics *dynamics = context;
    const Tree *tree = &dynamics->tree;
    const size_t n = tree->coordinate_count;
    DynamicsState state;
    if (!evaluate(dynamics, time_s, y, false, &state)) {
        for (size_t i = 0; i < dynamics_size(dynamics); i++) {
            rates[i] = NAN;
        }
        return;
    }
    double *sums = rates + 2 * n;
    memcpy(rates, y + n, n * sizeof *rates);
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const Motion *motion = &state.tree.motions[node->body];
        rates[n + node->angle_column] = motion->alpha;
        if (node->joint < 0) {
            rates[n + node->angle_column - 2] = motion->acceleration.x;
            rates[n + node->angle_column - 1] = motion->acceleration.y;
        }
    }
    sums[DYNAMICS_DRIVE_WORK] = state.drive_power;
    sums[DYNAMICS_DISSIPATED] = 0.0;
    sums[DYNAMICS_FRICTION] = 0.0;
    for (size_t i = 0; i < dynamics->contact_count; i++) {
        sums[DYNAMICS_DISSIPATED] += state.contacts[i].damping_power;
        sums[DYNAMICS_FRICTION] += state.contacts[i].friction_power;
        const Vec2 force = state.contacts[i].force;
        sums[DYNAMICS_IMPULSES + i] = sqrt(vec2_dot(force, force));
    }
}

ContactForce dynamics_contact(const Dynamics *dynamics, size_t contact, double time_s,
                              const double *y)
{
    TreeState tree;
    tree_evaluate(&dynamics->tree, time_s, y, y + dynamics->tree.coordinate_count, &tree);
    ContactForce force;
    find_contact(dynamics, contact, &tree, &force);
    return force;
}

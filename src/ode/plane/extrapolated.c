// Steps several worlds of different steps side by side, and combines their motions to one of higher
// order.
//
// The worlds give positions and speeds at nodes H apart (see Nodes). In between, each coordinate
// is the polynomial of degree 11 through positions and speeds at six nodes, three on each side;
// speeds and accelerations are its derivatives. The nodes run ahead of what is handed out by two
// intervals.
//
// Forces in the joints follow from the accelerations (ideal_forces_solve), those of the drive from
// the balance of the driven body. Work of the drive, P its power, over a part from t1 to t2:
//     W = (t2 - t1) / 6 (P(t1) + 4 P((t1 + t2) / 2) + P(t2))        (Simpson)
#include "base/dense.h"
#include "base/hermite.h"
#include "base/zeroed.h"
#include "model/joint_rows.h"
#include "model/kinematics.h"
#include "model/loads.h"
#include "model/response.h"
#include "model/scenario.h"
#include "model/trajectory.h"
#include "ode/plane/world.h"
#include "ode/stepping.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// The forces in the ideal joints that make the bodies move as they do.
//
// Newton and Euler of all bodies that are not driven, J the rows of the ideal joints:
//     M (a - g) - f = J' lambda,   so that   D lambda = J (a - g - M^-1 f),   D = J M^-1 J'
// f: springs, dampers, torque. a holds the angular accelerations too. J a is the bodies' part alone
// and without centripetal terms: this is a balance of forces, and says nothing of whether the
// joints stay closed. lambda is the force on body b of each revolute joint; of a prismatic joint
// the force across its line and the couple.

// One row of J (a - g - M^-1 f).
static double row_acceleration(const ResponseRow *row, const Linkage *linkage,
                               const Motion *motions, Vec2 gravity, const BodyLoad *loads)
{
    double sum = 0.0;
    for (int end = 0; end < 2; end++) {
        if (row->body[end] != LINKAGE_GROUND) {
            const Motion *motion = &motions[row->body[end]];
            const Body *body = &linkage->bodies[row->body[end]];
            const BodyLoad *load = &loads[row->body[end]];
            sum += row->x[end] * (motion->acceleration.x - gravity.x - load->force.x / body->mass) +
                   row->y[end] * (motion->acceleration.y - gravity.y - load->force.y / body->mass) +
                   row->turn[end] * (motion->alpha - load->moment / body->inertia);
        }
    }
    return sum;
}

static void set_force(const Linkage *linkage, const Motion *motions, int number,
                      const double *lambda, JointState *joint)
{
    joint->force_on_b = (Vec2){lambda[0], lambda[1]};
    joint->moment_on_b = 0.0;
    if (joint_slides(linkage->joints[number].kind)) {
        const Vec2 across = vec2_perp(joint_rows_along(linkage, motions, number));
        joint->force_on_b = vec2_scale(lambda[0], across);
        joint->moment_on_b = lambda[1];
    }
    joint->force = vec2_length(joint->force_on_b);
}

// Fills in force, force_on_b and moment_on_b of the ideal joints, the drive's joint apart, from
// positions and accelerations. The response must have been prepared for the scenario's linkage.
// Returns false where the forces are not determined; the joints are then untouched. `lambda` is to
// work with: a number for each ideal row of the response.
static bool ideal_forces_solve(const Scenario *scenario, const Motion *motions,
                               const BodyLoad *loads, Response *response, double *lambda,
                               JointState *joints)
{
    if (!response_place(response, motions)) {
        return false;
    }
    const size_t count = response->ideal_rows;
    for (size_t i = 0; i < count; i++) {
        lambda[i] = row_acceleration(&response->rows[i], &scenario->linkage, motions,
                                     scenario_gravity(scenario), loads);
    }
    response_solve(response, lambda);
    for (size_t i = 0; i < count; i += JOINT_ROWS) {
        const int number = response->joint_of[i];
        set_force(&scenario->linkage, motions, number, lambda + i, &joints[number]);
    }
    return true;
}

// The motion at the nodes, from worlds that are of second order each.
//
// Level j reaches the next node, H later, in n_j = 2, 3, 4, ... steps of h_j = H / n_j. Each step
//     G(x) v' = -G_d v_d' - phi(x) / h,   v' = v + h M^-1 (f + G' lambda),   x' = x + h v'
// has x half a step behind v: the driven body (d) stands where it is in the middle of the step,
// with the speed of its end, and ERP 1 takes back what the last step left open. At a node
//     q = x - h/2 v,   error of q and v: c2 h^2 + c3 h^3 + ...
// (h^3 too, as the joints' rows are linearised in the middle of the step). The combination
//     sum w_j = 1,   sum w_j h_j^p = 0,  p = 2 .. L
// of L levels is of order L + 1. Nothing goes back into the worlds.
//
// The c's are smooth only once the rows hold the values of a motion that has long been going on:
// the gap phi = h^2/2 (relative centripetal acceleration). A world gets there by itself, the
// difference falling by a factor of order h each step, so that it starts early. Where everything
// follows from the drive it starts where the linkage stood then. Else it goes there: a leapfrog
// turned round, its speeds negated and its last half steps taken back, goes backwards. That shifts
// the motion by powers of h from h^2 on, which the weights take away with the rest.
//
// Source: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed.,
// Springer 1993, II.8 and II.9.

enum {
    NODES_LEVEL_MAX = 6,
    NODES_KEPT = 6, // the newest ones
};

// One world and its steps.
typedef struct NodesLevel {
    World world;
    size_t steps_a_node;
    double step_s;
    double weight;  // 1, of its motion in the nodes'
    long index;     // steps from node zero to where its speeds stand
    double *turned; // rad, angles half a step later: what whole turns they have; owned
} NodesLevel;

// One body at one node.
typedef struct NodeState {
    double position[3]; // x and y of the centre of mass, m; angle, rad, not wrapped
    double speed[3];    // m/s, m/s, rad/s
} NodeState;

typedef struct Nodes {
    const Scenario *scenario;
    double origin_s;   // of node zero: time zero, or where a load has jumped
    double interval_s; // from node to node
    bool holds_jumps;  // whether loads that jump keep the value that they have from there on
    bool is_driven;    // whether the drive alone determines the motion
    size_t level_count;
    NodesLevel levels[NODES_LEVEL_MAX];
    bool is_started;
    size_t steps;                  // of all worlds so far
    long next;                     // number of the node that comes next
    size_t kept;                   // nodes kept of those before it
    NodeState *states[NODES_KEPT]; // at those, in order; not of the driven body; owned
    Motion *start;                 // at time zero; owned
    Motion *motions;               // to work with; owned
} Nodes;

enum {
    FIRST_STEPS = 2,  // a node, of the coarsest world
    SETTLE_STEPS = 4, // two are not enough for order 6, eight change nothing
    NODES_BEFORE = 2, // time zero, so that the first interval is in the middle of its six nodes too
};

// A start takes some ten intervals' steps.
static const double INTERVALS_A_JUMP = 20.0;

// The weights that leave no error in h^2 .. h^L.
static void set_weights(Nodes *nodes)
{
    const size_t count = nodes->level_count;
    double matrix[NODES_LEVEL_MAX * NODES_LEVEL_MAX];
    double weights[NODES_LEVEL_MAX] = {1.0};
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < count; k++) {
            const double share = (double)FIRST_STEPS / (double)nodes->levels[k].steps_a_node;
            matrix[i * count + k] = i == 0 ? 1.0 : pow(share, (double)(i + 1));
        }
    }
    const bool is_solved = dense_solve(count, matrix, weights);
    assert(is_solved);
    (void)is_solved;
    for (size_t k = 0; k < count; k++) {
        nodes->levels[k].weight = weights[k];
    }
}

// Puts every body half a step ahead of its motion, with its speeds.
static void place_level(NodesLevel *level, size_t body_count, const Motion *motions)
{
    const double half_s = 0.5 * level->step_s;
    for (size_t i = 0; i < body_count; i++) {
        Motion motion = motions[i];
        motion.position = vec2_add(motion.position, vec2_scale(half_s, motion.velocity));
        motion.angle += half_s * motion.omega;
        level->turned[i] = motion.angle;
        world_place(&level->world, i, &motion);
    }
}

// Takes back the half step that the bodies are ahead.
static void read_level(const NodesLevel *level, size_t body_count, Motion *motions)
{
    const double half_s = 0.5 * level->step_s;
    for (size_t i = 0; i < body_count; i++) {
        const Snapshot now = world_snapshot(&level->world, i);
        double angle = atan2(now.direction.y, now.direction.x);
        angle += 2.0 * M_PI * round((level->turned[i] - angle) / (2.0 * M_PI));
        motions[i] = (Motion){
            .position = vec2_sub(now.position, vec2_scale(half_s, now.velocity)),
            .angle = angle - half_s * now.omega,
            .velocity = now.velocity,
            .omega = now.omega,
        };
    }
}

static void negate_speeds(size_t body_count, Motion *motions)
{
    for (size_t i = 0; i < body_count; i++) {
        motions[i].velocity = vec2_scale(-1.0, motions[i].velocity);
        motions[i].omega *= -1.0;
    }
}

// One step of one world, forwards (1) or backwards (-1) in time.
static bool step_level(Nodes *nodes, NodesLevel *level, long direction, Err *err)
{
    const Scenario *scenario = nodes->scenario;
    const Linkage *linkage = &scenario->linkage;
    const double start_s = nodes->origin_s + (double)level->index * level->step_s;
    const double step_s = (double)direction * level->step_s;
    if (forces_damp(linkage)) {
        world_place_driven(&level->world, start_s + 0.5 * step_s, start_s, direction);
    }
    applied_push(&level->world.applied, start_s, level->step_s, APPLIED_AT_MEAN, (int)direction);
    world_place_driven(&level->world, start_s + 0.5 * step_s, start_s + step_s, direction);
    const bool is_quick = scenario->ode.solver == ODE_QUICK;
    nodes->steps++;
    if (!world_step(&level->world, level->step_s, is_quick, err) ||
        !world_check(&level->world, err)) {
        return stepping_fail(scenario, start_s, nodes->steps, level->step_s, err);
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        level->turned[i] += level->step_s * dBodyGetAngularVel(level->world.bodies[i])[2];
    }
    level->index += direction;
    return true;
}

// Lets the world itself go back by a number of steps, and reverses it there.
static bool run_back(Nodes *nodes, NodesLevel *level, long steps, Motion *motions, Err *err)
{
    const size_t body_count = nodes->scenario->linkage.body_count;
    negate_speeds(body_count, motions);
    place_level(level, body_count, motions);
    while (level->index > -steps) {
        if (!step_level(nodes, level, -1, err)) {
            return false;
        }
    }
    read_level(level, body_count, motions);
    negate_speeds(body_count, motions);
    return true;
}

// Puts a world to where it starts, before node zero, where the bodies move as they do in `from`.
static bool start_level(Nodes *nodes, NodesLevel *level, const Motion *from, Err *err)
{
    const Linkage *linkage = &nodes->scenario->linkage;
    const long steps = NODES_BEFORE * (long)level->steps_a_node + SETTLE_STEPS;
    Motion *motions = nodes->motions;
    level->index = 0;
    level->world.applied.is_held = nodes->holds_jumps;
    level->world.applied.held_s = nodes->origin_s;
    if (nodes->is_driven) {
        level->index = -stepping_start(nodes->scenario, level->step_s, steps, motions);
    } else {
        memcpy(motions, from, linkage->body_count * sizeof *motions);
        if (!run_back(nodes, level, steps, motions, err)) {
            return false;
        }
    }
    place_level(level, linkage->body_count, motions);
    return true;
}

// Whether the drive alone determines the motion.
static bool is_determined(const Linkage *linkage, Motion *motions)
{
    Err unused = {ERR_NONE, ""};
    DriveState drives[LINKAGE_DRIVE_MAX];
    linkage_start(linkage, motions);
    linkage_drives_since(linkage, 0.0, 0.0, drives);
    return kinematics_solve_driven(linkage, drives, motions, &unused);
}

// Whether loads jump, and so seldom that starting anew there costs less than the run itself.
static bool jumps_seldom(const Nodes *nodes)
{
    const double duration_s = scenario_duration(nodes->scenario);
    const double most = duration_s / (INTERVALS_A_JUMP * nodes->interval_s);
    double count = 0.0;
    double jump_s = loads_next_jump(&nodes->scenario->linkage, 0.0);
    while (jump_s < duration_s && count <= most) {
        count += 1.0;
        jump_s = loads_next_jump(&nodes->scenario->linkage, jump_s);
    }
    return count > 0.0 && count <= most;
}

// Starts all worlds and finds the first node that all of them come to settled.
static bool start_levels(Nodes *nodes, const Motion *from, Err *err)
{
    nodes->kept = 0;
    nodes->next = -NODES_BEFORE;
    for (size_t k = 0; k < nodes->level_count; k++) {
        NodesLevel *level = &nodes->levels[k];
        if (!start_level(nodes, level, from, err)) {
            return false;
        }
        const long settled = level->index + SETTLE_STEPS;
        const long first = settled < 0 ? settled / (long)level->steps_a_node : 0;
        nodes->next = first > nodes->next ? first : nodes->next;
    }
    nodes->is_started = true;
    return true;
}

// Adds what one world says of a node.
static void add_level(const NodesLevel *level, size_t body_count, Motion *motions,
                      NodeState *states)
{
    read_level(level, body_count, motions);
    for (size_t i = 0; i < body_count; i++) {
        states[i].position[0] += level->weight * motions[i].position.x;
        states[i].position[1] += level->weight * motions[i].position.y;
        states[i].position[2] += level->weight * motions[i].angle;
        states[i].speed[0] += level->weight * motions[i].velocity.x;
        states[i].speed[1] += level->weight * motions[i].velocity.y;
        states[i].speed[2] += level->weight * motions[i].omega;
    }
}

// Works out the next node. The first one is two intervals before time zero, or later where the
// linkage cannot be followed back that far. Fails with ERR_SOLVER where a step of a world does.
static bool nodes_advance(Nodes *nodes, Err *err)
{
    if (!nodes->is_started && !start_levels(nodes, nodes->start, err)) {
        return false;
    }
    // the oldest one makes room
    if (nodes->kept == NODES_KEPT) {
        NodeState *const oldest = nodes->states[0];
        memmove(nodes->states, nodes->states + 1, (NODES_KEPT - 1) * sizeof *nodes->states);
        nodes->states[--nodes->kept] = oldest;
    }
    const size_t body_count = nodes->scenario->linkage.body_count;
    NodeState *states = nodes->states[nodes->kept];
    memset(states, 0, body_count * sizeof *states);
    for (size_t k = 0; k < nodes->level_count; k++) {
        NodesLevel *level = &nodes->levels[k];
        while (level->index < nodes->next * (long)level->steps_a_node) {
            if (!step_level(nodes, level, 1, err)) {
                return false;
            }
        }
        add_level(level, body_count, nodes->motions, states);
    }
    nodes->kept++;
    nodes->next++;
    return true;
}

// Builds the worlds. From node to node it is as long as the scenario's step times the steps that
// all worlds together take there. The nodes must be zeroed, must not be copied, and are to be
// finished after a failure too.
static bool nodes_init(const Scenario *scenario, Nodes *nodes, Err *err)
{
    nodes->scenario = scenario;
    nodes->level_count = scenario->ode.levels;
    assert(nodes->level_count >= 2 && nodes->level_count <= NODES_LEVEL_MAX);
    size_t steps_a_node = 0;
    for (size_t k = 0; k < nodes->level_count; k++) {
        nodes->levels[k].steps_a_node = FIRST_STEPS + k;
        steps_a_node += FIRST_STEPS + k;
    }
    nodes->interval_s = (double)steps_a_node * scenario->run.step;
    set_weights(nodes);
    const size_t body_count = scenario->linkage.body_count;
    nodes->motions = zeroed(body_count, sizeof *nodes->motions);
    for (size_t k = 0; k < NODES_KEPT; k++) {
        nodes->states[k] = zeroed(body_count, sizeof *nodes->states[k]);
    }
    nodes->start = zeroed(body_count, sizeof *nodes->start);
    nodes->is_driven = is_determined(&scenario->linkage, nodes->motions);
    nodes->holds_jumps = !nodes->is_driven && jumps_seldom(nodes);
    linkage_start(&scenario->linkage, nodes->start);
    memcpy(nodes->motions, nodes->start, body_count * sizeof *nodes->start);
    for (size_t k = 0; k < nodes->level_count; k++) {
        NodesLevel *level = &nodes->levels[k];
        level->turned = zeroed(body_count, sizeof *level->turned);
        level->step_s = nodes->interval_s / (double)level->steps_a_node;
        if (!world_build(scenario, nodes->motions, &level->world, err)) {
            return false;
        }
    }
    return true;
}

static void nodes_finish(Nodes *nodes)
{
    for (size_t k = 0; k < NODES_LEVEL_MAX; k++) {
        world_finish(&nodes->levels[k].world);
        free(nodes->levels[k].turned);
    }
    for (size_t k = 0; k < NODES_KEPT; k++) {
        free(nodes->states[k]);
    }
    free(nodes->start);
    free(nodes->motions);
}

static void nodes_carry(Nodes *nodes, Carry *carry)
{
    const size_t count = nodes->scenario->linkage.body_count;
    for (size_t k = 0; k < nodes->level_count; k++) {
        NodesLevel *level = &nodes->levels[k];
        world_carry(&level->world, carry);
        CARRY(carry, level->world.applied.held_s);
        CARRY(carry, level->world.applied.is_held);
        CARRY(carry, level->index);
        CARRY_ARRAY(carry, level->turned, count);
    }
    for (size_t k = 0; k < NODES_KEPT; k++) {
        CARRY_ARRAY(carry, nodes->states[k], count);
    }
    CARRY(carry, nodes->origin_s);
    CARRY(carry, nodes->is_started);
    CARRY(carry, nodes->steps);
    CARRY(carry, nodes->next);
    CARRY(carry, nodes->kept);
}

// of an interval: a part that ends so close to a node goes up to it, or as little beyond
static const double ROUNDING = 1e-6;

// W, of the drive and the loads, and what the dampers take.
typedef struct Powers {
    double drive;
    double damping;
    double loads;
} Powers;

typedef struct Extrapolated {
    const Scenario *scenario;
    Nodes nodes;
    Response *response;  // room to work in; owned
    bool is_begun;       // the part at time zero has been handed out
    long interval;       // number of the node before it
    Hermite (*paths)[3]; // x, y and angle in the interval; owned, as are all arrays
    double jump_s;       // where a load jumps next and all is begun anew; INFINITY: nowhere
    double start_s;      // of the last part
    Sample begin;        // of it, once the next one is being made
    Sample middle;       // likewise
    Sample end;          // of it
    Powers powers;       // there
    double drive_work;   // J, in the last part
    double load_work;    // J, likewise
    double damped;       // J, in dampers, likewise
    double *omega;
    double *alpha;
    double *impulse;
    double *approach; // zero: an ideal joint never begins to touch
    BodyLoad *loads;  // to work with, as the next
    Vec2 *offsets;
    double *rows; // of the response
} Extrapolated;

static void extrapolated_close(void *state)
{
    Extrapolated *own = state;
    if (own != NULL) {
        nodes_finish(&own->nodes);
        response_finish(own->response);
        sample_free(&own->begin);
        sample_free(&own->middle);
        sample_free(&own->end);
        free(own->response);
        free(own->paths);
        free(own->omega);
        free(own->alpha);
        free(own->impulse);
        free(own->approach);
        free(own->loads);
        free(own->offsets);
        free(own->rows);
        free(own);
    }
}

static void make_extrapolated(const Linkage *linkage, Extrapolated *own)
{
    own->response = zeroed(1, sizeof *own->response);
    response_init(linkage, false, own->response);
    own->paths = zeroed(linkage->body_count, sizeof *own->paths);
    own->omega = zeroed(linkage->body_count, sizeof *own->omega);
    own->alpha = zeroed(linkage->body_count, sizeof *own->alpha);
    own->impulse = zeroed(linkage->joint_count, sizeof *own->impulse);
    own->approach = zeroed(linkage->joint_count, sizeof *own->approach);
    own->loads = zeroed(linkage->body_count, sizeof *own->loads);
    own->offsets = zeroed(linkage->joint_count, sizeof *own->offsets);
    own->rows = zeroed(own->response->ideal_rows, sizeof *own->rows);
}

// Finds where the nodes have to begin anew.
static void set_jump(Extrapolated *own)
{
    own->jump_s = own->nodes.holds_jumps
                      ? loads_next_jump(&own->scenario->linkage, own->nodes.origin_s)
                      : INFINITY;
}

static bool extrapolated_open(const Scenario *scenario, void **state, Err *err)
{
    if (scenario_has_clearance(scenario)) {
        return err_set(err, ERR_SOLVER,
                       "extrapolated stepping is for ideal joints: contacts are not smooth");
    }
    Extrapolated *own = calloc(1, sizeof *own);
    assert(own != NULL);
    own->scenario = scenario;
    own->begin = sample_create(&scenario->linkage);
    own->middle = sample_create(&scenario->linkage);
    own->end = sample_create(&scenario->linkage);
    make_extrapolated(&scenario->linkage, own);
    if (nodes_init(scenario, &own->nodes, err)) {
        set_jump(own);
        *state = own;
        return true;
    }
    extrapolated_close(own);
    return false;
}

// Fits the paths through the nodes around an interval: three on each side of its middle, but where
// the nodes do not begin that early, the first six.
static bool enter_interval(Extrapolated *own, long interval, Err *err)
{
    Nodes *nodes = &own->nodes;
    while (nodes->next <= interval + NODES_KEPT / 2 || nodes->kept < NODES_KEPT) {
        if (!nodes_advance(nodes, err)) {
            return false;
        }
    }
    double times[NODES_KEPT];
    for (size_t k = 0; k < NODES_KEPT; k++) {
        const double count = (double)(nodes->next - NODES_KEPT + (long)k);
        times[k] = nodes->origin_s + count * nodes->interval_s;
    }
    for (size_t i = 0; i < own->scenario->linkage.body_count; i++) {
        for (size_t c = 0; c < 3; c++) {
            double positions[NODES_KEPT];
            double speeds[NODES_KEPT];
            for (size_t k = 0; k < NODES_KEPT; k++) {
                positions[k] = nodes->states[k][i].position[c];
                speeds[k] = nodes->states[k][i].speed[c];
            }
            own->paths[i][c] = hermite_fit(NODES_KEPT, times, positions, speeds);
        }
    }
    own->interval = interval;
    return true;
}

static void fill_motions(const Extrapolated *own, double time_s, Motion *motions)
{
    const Linkage *linkage = &own->scenario->linkage;
    for (int i = 0; i < (int)linkage->body_count; i++) {
        if (linkage_is_driven(linkage, i)) {
            continue;
        }
        const HermitePoint x = hermite_at(&own->paths[i][0], time_s);
        const HermitePoint y = hermite_at(&own->paths[i][1], time_s);
        const HermitePoint angle = hermite_at(&own->paths[i][2], time_s);
        motions[i] = (Motion){
            .position = {x.value, y.value},
            .angle = angle.value,
            .velocity = {x.slope, y.slope},
            .omega = angle.slope,
            .acceleration = {x.curvature, y.curvature},
            .alpha = angle.curvature,
        };
    }
    stepping_set_driven(linkage, time_s, motions);
}

// A time from which on loads are as they are at a time; where one jumps next, as before the jump.
static double before_jump(const Extrapolated *own, double time_s)
{
    return time_s < own->jump_s ? time_s : 0.5 * (own->nodes.origin_s + own->jump_s);
}

// The motions and the joints' forces at a time in the interval, and the powers. Returns false where
// the forces are not determined; they are then untouched.
static bool work_out(const Extrapolated *own, double time_s, Sample *sample, Powers *powers)
{
    const Linkage *linkage = &own->scenario->linkage;
    BodyLoad *loads = own->loads;
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    fill_motions(own, time_s, sample->bodies);
    const double from_s = before_jump(own, time_s);
    loads_of_all(linkage, sample->bodies, time_s, from_s, loads);
    if (!ideal_forces_solve(own->scenario, sample->bodies, loads, own->response, own->rows,
                            sample->joints)) {
        return false;
    }
    powers->drive = forces_torque_power(linkage, sample->bodies, time_s);
    powers->damping = forces_damping_power(linkage, sample->bodies);
    powers->loads = loads_power(linkage, sample->bodies, time_s, from_s);
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const int body = linkage_drive_body(linkage, i);
        stepping_offsets(linkage, sample->bodies, body, own->offsets);
        powers->drive += stepping_drive(own->scenario, i, &sample->bodies[body], &loads[body],
                                        own->offsets, sample->joints);
    }
    return true;
}

static void observe_joints(const Extrapolated *own, Sample *sample)
{
    for (size_t i = 0; i < own->scenario->linkage.joint_count; i++) {
        stepping_observe_joint(&own->scenario->linkage, i, sample);
    }
}

// Hands out the part from the end of the last one to a time in the interval.
static bool make_part(Extrapolated *own, double end_s, Err *err)
{
    sample_copy(&own->scenario->linkage, &own->end, &own->begin);
    const Sample start = own->begin;
    const Powers from = own->powers;
    const double sixth_s = (end_s - start.time_s) / 6.0;
    Sample middle = own->middle;
    Powers mid = {0.0, 0.0, 0.0};
    if (!work_out(own, 0.5 * (start.time_s + end_s), &middle, &mid) ||
        !work_out(own, end_s, &own->end, &own->powers)) {
        err_set(err, ERR_SOLVER,
                "the ideal joints are redundant: give one joint of the loop some play, or "
                "choose another stepping");
        return stepping_fail(own->scenario, start.time_s, own->nodes.steps, own->scenario->run.step,
                             err);
    }
    observe_joints(own, &own->end);
    own->start_s = start.time_s;
    own->drive_work = sixth_s * (from.drive + 4.0 * mid.drive + own->powers.drive);
    own->load_work = sixth_s * (from.loads + 4.0 * mid.loads + own->powers.loads);
    own->damped = sixth_s * (from.damping + 4.0 * mid.damping + own->powers.damping);
    for (size_t i = 0; i < own->scenario->linkage.body_count; i++) {
        own->omega[i] = own->end.bodies[i].omega;
        own->alpha[i] = own->end.bodies[i].alpha;
    }
    for (size_t i = 0; i < own->scenario->linkage.joint_count; i++) {
        own->impulse[i] = sixth_s * (start.joints[i].force + 4.0 * middle.joints[i].force +
                                     own->end.joints[i].force);
    }
    return true;
}

// Begins anew where a load jumps, with a part of no length, so that what stands behind the jump is
// on record.
static bool begin_anew(Extrapolated *own, Err *err)
{
    own->nodes.origin_s = own->jump_s;
    set_jump(own);
    return start_levels(&own->nodes, own->end.bodies, err) && enter_interval(own, 0, err) &&
           make_part(own, own->nodes.origin_s, err);
}

static bool extrapolated_step(void *state, double stop_s, Err *err)
{
    Extrapolated *own = state;
    if (!own->is_begun) {
        // a part of no length, so that what stands at time zero is on record
        own->is_begun = true;
        return enter_interval(own, 0, err) && make_part(own, 0.0, err);
    }
    if (own->end.time_s >= own->jump_s) {
        return begin_anew(own, err);
    }
    const double interval_s = own->nodes.interval_s;
    const double origin_s = own->nodes.origin_s;
    const double done = (own->end.time_s - origin_s) / interval_s - (double)own->interval;
    if (done > 1.0 - ROUNDING && !enter_interval(own, own->interval + 1, err)) {
        return false;
    }
    // no part goes beyond a node, or a jump
    const double node_s = origin_s + (double)(own->interval + 1) * interval_s;
    const double end_s = stop_s < node_s + ROUNDING * interval_s ? stop_s : node_s;
    return make_part(own, own->jump_s < end_s + ROUNDING * interval_s ? own->jump_s : end_s, err);
}

static bool extrapolated_carry(void *state, Carry *carry)
{
    Extrapolated *own = state;
    const Linkage *linkage = &own->scenario->linkage;
    nodes_carry(&own->nodes, carry);
    CARRY(carry, own->is_begun);
    CARRY(carry, own->jump_s);
    CARRY(carry, own->interval);
    CARRY_ARRAY(carry, own->paths, linkage->body_count);
    CARRY(carry, own->end.time_s);
    CARRY(carry, own->end.crank_rad);
    CARRY_ARRAY(carry, own->end.bodies, linkage->body_count);
    CARRY_ARRAY(carry, own->end.joints, linkage->joint_count);
    CARRY(carry, own->powers);
    return true;
}

static StepRecord extrapolated_record(const void *state)
{
    const Extrapolated *own = state;
    return (StepRecord){
        .start_s = own->start_s,
        .end_s = own->end.time_s,
        .joint_s = own->end.time_s,
        .omega = own->omega,
        .alpha = own->alpha,
        .joints = own->end.joints,
        .impulse = own->impulse,
        .approach = own->approach,
        .drive_work = own->drive_work,
        .load_work = own->load_work,
        .dissipated = own->damped,
    };
}

static void extrapolated_observe(const void *state, double time_s, Sample *sample)
{
    const Extrapolated *own = state;
    // should the forces not be determined, those of the end stand
    sample_copy(&own->scenario->linkage, &own->end, sample);
    if (time_s == own->end.time_s) {
        return;
    }
    Powers unused;
    work_out(own, time_s, sample, &unused);
    observe_joints(own, sample);
}

static SolverModel extrapolated_model(const void *state)
{
    const Extrapolated *own = state;
    SolverModel model = {
        .step_s = own->scenario->run.step,
        .constraint_rows = own->nodes.levels[0].world.constraint_rows,
        .steps = own->nodes.steps,
    };
    stepping_label(own->scenario, "extrapolated", NULL, model.label);
    return model;
}

const Solver STEPPING_EXTRAPOLATED = {
    .name = "extrapolated",
    .open = extrapolated_open,
    .step = extrapolated_step,
    .record = extrapolated_record,
    .observe = extrapolated_observe,
    .carry = extrapolated_carry,
    .model = extrapolated_model,
    .close = extrapolated_close,
};

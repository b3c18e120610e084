// How do worlds that are second order each give a motion of higher order?
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
#include "ode/nodes.h"

#include "base/dense.h"
#include "base/zeroed.h"
#include "model/kinematics.h"
#include "ode/stepping.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum {
    FIRST_STEPS = 2,  // a node, of the coarsest world
    SETTLE_STEPS = 4, // two are not enough for order 6, eight change nothing
    NODES_BEFORE = 2, // time zero, so that the first interval is in the middle of its six nodes too
};

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
    const int driven = linkage_driven_body(linkage);
    const double start_s = (double)level->index * level->step_s;
    const double step_s = (double)direction * level->step_s;
    const bool has_driven_speed = driven >= 0 && forces_damp(linkage);
    if (has_driven_speed) {
        Motion motion = stepping_driven(linkage, start_s + 0.5 * step_s);
        const Motion start = stepping_driven(linkage, start_s);
        motion.velocity = vec2_scale((double)direction, start.velocity);
        motion.omega = (double)direction * start.omega;
        world_place(&level->world, (size_t)driven, &motion);
    }
    applied_push(&level->world.applied, start_s, level->step_s, APPLIED_AT_MEAN, (int)direction);
    if (driven >= 0) {
        Motion motion = stepping_driven(linkage, start_s + 0.5 * step_s);
        const Motion end = stepping_driven(linkage, start_s + step_s);
        motion.velocity = vec2_scale((double)direction, end.velocity);
        motion.omega = (double)direction * end.omega;
        world_place(&level->world, (size_t)driven, &motion);
    }
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

// Puts a world to where it starts, before time zero.
static bool start_level(Nodes *nodes, NodesLevel *level, Err *err)
{
    const Linkage *linkage = &nodes->scenario->linkage;
    const long steps = NODES_BEFORE * (long)level->steps_a_node + SETTLE_STEPS;
    Motion *motions = nodes->motions;
    linkage_start(linkage, motions);
    Err unused = {ERR_NONE, ""};
    if (kinematics_solve(linkage, linkage_crank_angle(linkage, 0.0), motions, &unused)) {
        level->index = -stepping_start(nodes->scenario, level->step_s, steps, motions);
    } else if (!run_back(nodes, level, steps, motions, err)) {
        return false;
    }
    place_level(level, linkage->body_count, motions);
    return true;
}

// Starts all worlds and finds the first node that all of them come to settled.
static bool start_levels(Nodes *nodes, Err *err)
{
    nodes->next = -NODES_BEFORE;
    for (size_t k = 0; k < nodes->level_count; k++) {
        NodesLevel *level = &nodes->levels[k];
        if (!start_level(nodes, level, err)) {
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

bool nodes_advance(Nodes *nodes, Err *err)
{
    if (!nodes->is_started && !start_levels(nodes, err)) {
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

bool nodes_init(const Scenario *scenario, Nodes *nodes, Err *err)
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
    linkage_start(&scenario->linkage, nodes->motions);
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

void nodes_finish(Nodes *nodes)
{
    for (size_t k = 0; k < NODES_LEVEL_MAX; k++) {
        world_finish(&nodes->levels[k].world);
        free(nodes->levels[k].turned);
    }
    for (size_t k = 0; k < NODES_KEPT; k++) {
        free(nodes->states[k]);
    }
    free(nodes->motions);
}

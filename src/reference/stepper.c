// How does the motion get from one event to the next?
//
// Errors are allowed relative to the speed of the fastest point of the mechanism: tolerance times
// that in the speed of each body's furthest joint, and that times the step in each coordinate, so
// that a penetration of a micron in a linkage of half a metre keeps its digits, however far a body
// is from the pivot that it turns about. Work and losses are allowed the tolerance times m v^2.
#include "reference/stepper.h"

#include "reference/dynamics_slopes.h"
#include "reference/loops.h"

#include <float.h>
#include <string.h>

// of a step: two events nearer to each other than this are one, seen with rounding
static const double SAME = 1e-9;

// of the deepest penetration a law knows: a pin that cannot be followed beyond it is at its end
static const double NEARLY = 0.99;

// Shares of a tolerance that speeds of centres and of furthest joints have: measured, a four-bar
// with two loose joints then errs by some forty times its tolerance
static const double MOVING_SHARE = 1.2;
static const double TURNING_SHARE = 0.6;

// The error allowed in positions, over that in rates times the step: measured on the paper's
// mechanism, an error of 1e-9 costs a fifth less than at 1, and no less from 8 to 32.
static const double POSITION_SHARE = 16.0;

// 1: eight times the rounding of a number, for an estimate of the error that sees as much as it
// allows lets no step grow
static const double ROUNDING = 0x1p-50;

// of the time: below this, rounding of the time would show in a step
static const double SHORTEST = 16.0 * DBL_EPSILON;

// Lets the sizes of errors follow the largest speeds so far.
static void set_tolerances(Stepper *stepper)
{
    const Tree *tree = &stepper->dynamics.tree;
    const size_t n = tree->coordinate_count;
    const double tolerance = stepper->scenario->reference.tolerance;
    const SpeedScale *scale = &stepper->scale;
    const double moving = MOVING_SHARE * tolerance * scale->moving;
    Dop853 *integrator = &stepper->integrator;
    for (size_t i = 0; i < n; i++) {
        integrator->fixed[n + i] = moving;
        integrator->grown[i] = POSITION_SHARE * moving;
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const size_t angle = tree->nodes[i].angle_column;
        const double turning = TURNING_SHARE * tolerance * scale->turning[tree->nodes[i].body];
        integrator->fixed[n + angle] = turning;
        integrator->grown[angle] = POSITION_SHARE * turning;
    }
    // the bodies' mean speed is some tenth of the largest scale, and work goes to and fro
    const double energy_share = 3e-2;
    double mass = 0.0;
    for (size_t i = 0; i < stepper->scenario->linkage.body_count; i++) {
        mass += stepper->scenario->linkage.bodies[i].mass;
    }
    double *sums = integrator->fixed + dynamics_sum_index(&stepper->dynamics, 0);
    sums[DYNAMICS_DRIVE_WORK] = energy_share * mass * moving * scale->moving;
    sums[DYNAMICS_DISSIPATED] = energy_share * mass * moving * scale->moving;
    sums[DYNAMICS_FRICTION] = energy_share * mass * moving * scale->moving;
    for (size_t i = 0; i < stepper->dynamics.contact_count; i++) {
        sums[DYNAMICS_IMPULSES + i] = mass * moving;
    }
}

// Allows the errors that no step can avoid: rounding of a pin's position in its hole, times the
// stiffness that it presses on there, is a force, and the rates feel it for as long as the step.
static void allow_rounding(Stepper *stepper)
{
    const Tree *tree = &stepper->dynamics.tree;
    const DynamicsState *state = &stepper->points.states[stepper->points.count - 1];
    const size_t n = tree->coordinate_count;
    double *fixed = stepper->integrator.fixed;
    double *grown = stepper->integrator.grown;
    double *sums = grown + dynamics_sum_index(&stepper->dynamics, 0);
    const bool is_stiff = stepper->integrator.method != NULL;
    double force = 0.0;
    double damped = 0.0;
    double moved = 0.0;
    for (size_t i = 0; i < stepper->dynamics.contact_count; i++) {
        const DynamicsContact *contact = &stepper->dynamics.contacts[i];
        const double rounding = ROUNDING * contact->radial_clearance;
        // a contact that rounding alone keeps from its end is continued below zero depth
        const double depth = fmax(fabs(state->contacts[i].pose.penetration), rounding);
        if (contact->mode == CONTACT_PRESSING) {
            force += rounding * force_law_tangent(&contact->law, depth);
            damped +=
                ROUNDING * stepper->scale.moving * stiffness_damping(contact, &state->contacts[i]);
        }
        moved = moved > 0.0 ? fmin(moved, rounding) : rounding;
        sums[DYNAMICS_IMPULSES + i] = force + (is_stiff ? damped : 0.0);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const Body *body = &tree->linkage->bodies[node->body];
        const double reach = linkage_reach(tree->linkage, node->body);
        double inertia = body->inertia;
        if (node->joint < 0) {
            grown[n + node->angle_column - 2] = force / body->mass;
            grown[n + node->angle_column - 1] = force / body->mass;
            fixed[node->angle_column - 2] = moved;
            fixed[node->angle_column - 1] = moved;
        } else {
            const Vec2 arm = tree->anchors[node->own_end];
            inertia += body->mass * vec2_dot(arm, arm);
        }
        grown[n + node->angle_column] = force * reach / inertia;
        fixed[node->angle_column] = moved / reach;
    }
    force += is_stiff ? damped : 0.0;
    sums[DYNAMICS_DRIVE_WORK] = force * stepper->scale.moving;
    sums[DYNAMICS_DISSIPATED] = force * stepper->scale.moving;
    sums[DYNAMICS_FRICTION] = force * stepper->scale.moving;
}

// Raises the scale where a body has become faster than any before.
static void follow_speeds(Stepper *stepper)
{
    const Tree *tree = &stepper->dynamics.tree;
    const TreeState *state = &stepper->points.states[stepper->points.count - 1].tree;
    const Linkage *linkage = tree->linkage;
    double moving = 0.0;
    for (size_t i = 0; i < tree->node_count; i++) {
        const int body = tree->nodes[i].body;
        const Motion *motion = &state->motions[body];
        const double speed = sqrt(vec2_dot(motion->velocity, motion->velocity));
        moving = fmax(moving, speed + fabs(motion->omega) * linkage_reach(linkage, body));
    }
    if (scale_raise(linkage, moving, &stepper->scale)) {
        set_tolerances(stepper);
    }
}

bool stepper_init(Stepper *stepper, const Scenario *scenario, Err *err)
{
    memset(stepper, 0, sizeof *stepper);
    stepper->scenario = scenario;
    stepper->duration_s = scenario_duration(scenario);
    if (!dynamics_init(scenario, &stepper->dynamics, err)) {
        return false;
    }
    const size_t n = stepper->dynamics.tree.coordinate_count;
    Motion motions[LINKAGE_BODY_MAX];
    linkage_start(&scenario->linkage, motions);
    double y[DOP853_SIZE_MAX] = {0.0};
    tree_start(&stepper->dynamics.tree, motions, y + n);
    loops_start(&stepper->dynamics.tree, y, y + n);
    Dop853 *integrator = &stepper->integrator;
    integrator->size = dynamics_size(&stepper->dynamics);
    integrator->motion_size = dynamics_sum_index(&stepper->dynamics, 0);
    integrator->rates = dynamics_rates;
    integrator->slopes = dynamics_slopes;
    integrator->context = &stepper->dynamics;
    stepper->scale = scale_speeds(scenario);
    set_tolerances(stepper);
    // the first step finds its own length: a thousandth of the run is long enough to be shortened
    integrator->step = 1e-3 * stepper->duration_s;
    stepper->onset_step = integrator->step;
    dop853_start(integrator, 0.0, y);
    stepper->points.count = 1;
    if (!dynamics_evaluate(&stepper->dynamics, 0.0, y, &stepper->points.states[0])) {
        return pace_undetermined(err);
    }
    return true;
}

void stepper_finish(Stepper *stepper)
{
    stiffness_finish(&stepper->stiffness);
}

// Whether a contact begins to press at the end of the step.
static bool is_onset(const Stepper *stepper)
{
    for (size_t i = 0; i < stepper->events.count; i++) {
        if (stepper->events.events[i].mode == CONTACT_PRESSING) {
            return true;
        }
    }
    return false;
}

// Makes the end of the last step the start of the next, with the events there.
static void take_over(Stepper *stepper)
{
    Dop853 *integrator = &stepper->integrator;
    Tree *tree = &stepper->dynamics.tree;
    const size_t n = tree->coordinate_count;
    follow_speeds(stepper);
    allow_rounding(stepper);
    dop853_accept(integrator);
    if (tree->loop_count > 0) {
        loops_project(tree, integrator->time, integrator->y, integrator->y + n);
    }
    // time and coordinates count from here on
    tree_rebase(tree, integrator->time, integrator->y);
    integrator->time = 0.0;
    integrator->shortest = SHORTEST * tree_time(tree, 0.0);
    if (stepper->events.count > 0) {
        events_apply(&stepper->dynamics, &stepper->events, integrator->time, integrator->y);
        if (is_onset(stepper)) {
            integrator->step = fmin(integrator->step, stepper->onset_step);
        }
    }
    if (tree->loop_count > 0 || stepper->events.count > 0) {
        dop853_start(integrator, integrator->time, integrator->y);
    }
    stiffness_follow(&stepper->stiffness, &stepper->dynamics,
                     &stepper->points.states[stepper->points.count - 1], &stepper->scale,
                     stepper->events.count > 0, integrator);
}

// The longest step in which no free pin crosses more than its play: error control alone lets a free
// flight, which it integrates exactly, be as long as it likes.
static double flight_limit(const Stepper *stepper)
{
    const Tree *tree = &stepper->dynamics.tree;
    const TreeState *state = &stepper->points.states[stepper->points.count - 1].tree;
    double limit = stepper->duration_s - tree_time(tree, 0.0);
    for (size_t i = 0; i < stepper->dynamics.contact_count; i++) {
        const DynamicsContact *contact = &stepper->dynamics.contacts[i];
        if (contact->mode == CONTACT_PRESSING) {
            continue;
        }
        const Vec2 v = tree_joint_velocity(tree, state, contact->joint);
        const Vec2 a = tree_joint_acceleration(tree, state, contact->joint);
        const double play = contact->radial_clearance;
        const double speed = vec2_length(v) + sqrt(play * vec2_length(a));
        limit = speed > 0.0 ? fmin(limit, play / speed) : limit;
    }
    return limit;
}

// Why a step came to nothing: a pin past the end of its law, or a motion too rough to follow.
static bool fail_to_step(const Stepper *stepper, Err *err)
{
    const Dop853 *integrator = &stepper->integrator;
    DynamicsState state;
    if (dynamics_evaluate(&stepper->dynamics, integrator->time, integrator->y, &state) &&
        !dynamics_check_depth(&stepper->dynamics, &state, NEARLY, err)) {
        return false;
    }
    return err_set(err, ERR_SOLVER,
                   "the step fell below the rounding of time: the motion cannot be integrated at a "
                   "tolerance of %g; raise reference.tolerance",
                   stepper->scenario->reference.tolerance);
}

// Tries and fills one step, shortened to the first event in it.
static bool step_to_event(Stepper *stepper, Err *err)
{
    const Dynamics *dynamics = &stepper->dynamics;
    Dop853 *integrator = &stepper->integrator;
    if (!dop853_attempt(integrator, flight_limit(stepper))) {
        return fail_to_step(stepper, err);
    }
    dop853_fill(integrator);
    const double same_s = SAME * integrator->tried;
    Event landed = {.time = INFINITY};
    stepper->events.count = 0;
    for (size_t i = 0; i <= dynamics->contact_count; i++) {
        if (!events_look(dynamics, integrator, &stepper->points)) {
            return pace_undetermined(err);
        }
        // a shorter step sees better: it may show an event before the one it was cut to
        EventList found;
        events_find(dynamics, integrator, &stepper->points, &found);
        const Event *first = events_first(&found);
        if (first == NULL || first->time >= landed.time - SAME * integrator->tried) {
            break;
        }
        landed = *first;
        events_land(dynamics, integrator, &landed);
        stepper->events = found;
    }
    if (stepper->events.count > 0) {
        events_gather(dynamics, integrator, &landed, same_s, &stepper->events);
    }
    return true;
}

bool stepper_next(Stepper *stepper, Err *err)
{
    Dop853 *integrator = &stepper->integrator;
    stepper->is_after_onset = false;
    do {
        bool has_begun = false;
        if (stepper->has_step) {
            has_begun = is_onset(stepper);
            stepper->is_after_onset = stepper->is_after_onset || has_begun;
            take_over(stepper);
        }
        const double time_s = tree_time(&stepper->dynamics.tree, 0.0);
        if (!pace_keep(&stepper->pace, &stepper->dynamics, &stepper->events, time_s, err) ||
            !step_to_event(stepper, err)) {
            return false;
        }
        stepper->has_step = true;
        // a step that an event has cut says nothing about the next contact
        if (has_begun && stepper->events.count == 0) {
            stepper->onset_step = integrator->tried;
        }
    } while (integrator->tried == 0.0);
    return true;
}

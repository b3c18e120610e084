// How does the motion get from one event to the next?
//
// Errors are allowed relative to the rates of the whole mechanism: tolerance times the largest
// speed in each rate, and that times the step in each coordinate, so that a penetration of a micron
// in a linkage of half a metre keeps its digits. Work and losses are allowed the tolerance times m
// v^2.
#include "reference/stepper.h"

#include "reference/loops.h"

#include <string.h>

// events at one and the same instant: a contact that begins at rest, another that ends with it
enum { STANDSTILL_MAX = 8 };

// The largest rates that set the size of errors: of angles, rad/s, and of places, m/s.
static void rate_scales(const Stepper *stepper, double *turning, double *moving)
{
    const Scenario *scenario = stepper->scenario;
    const Tree *tree = &stepper->dynamics.tree;
    double reach = 0.0;
    double play = 0.0;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        reach = fmax(reach, fmax(vec2_length(joint->anchor_a), vec2_length(joint->anchor_b)));
        reach = fmax(reach, joint->clearance.hole_radius);
        play = fmax(play, joint->clearance.hole_radius - joint->clearance.pin_radius);
    }
    *turning = fabs(scenario->linkage.driver.speed);
    // nothing moves yet: it will at the speed of a fall through the play
    *moving = sqrt(2.0 * fabs(scenario->gravity) * play);
    for (size_t i = 0; i < tree->node_count; i++) {
        const Motion *motion = &scenario->linkage.bodies[tree->nodes[i].body].start;
        *turning = fmax(*turning, fabs(motion->omega));
        *moving = fmax(*moving, vec2_length(motion->velocity));
    }
    *moving = fmax(*moving, *turning * reach);
    *turning = fmax(*turning, reach > 0.0 ? *moving / reach : 1.0);
    *moving = *moving > 0.0 ? *moving : 1.0;
}

// Places may err by so many times what rates times the step would allow: measured on the paper's
// mechanism, an error of 1e-9 costs a fifth less than at 1, and no less from 8 to 32.
static const double PLACE_SHARE = 16.0;

static void set_tolerances(Stepper *stepper)
{
    const Tree *tree = &stepper->dynamics.tree;
    const size_t n = tree->coordinate_count;
    const double tolerance = stepper->scenario->reference.tolerance;
    Dop853 *integrator = &stepper->integrator;
    double turning;
    double moving;
    rate_scales(stepper, &turning, &moving);
    for (size_t i = 0; i < n; i++) {
        integrator->fixed[n + i] = tolerance * moving;
        integrator->grown[i] = PLACE_SHARE * tolerance * moving;
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const size_t angle = tree->nodes[i].angle_column;
        integrator->fixed[n + angle] = tolerance * turning;
        integrator->grown[angle] = PLACE_SHARE * tolerance * turning;
    }
    double energy = 0.0;
    for (size_t i = 0; i < stepper->scenario->linkage.body_count; i++) {
        energy += stepper->scenario->linkage.bodies[i].mass * moving * moving;
    }
    const size_t sums = dynamics_sum_index(&stepper->dynamics, 0);
    integrator->fixed[sums + DYNAMICS_DRIVE_WORK] = tolerance * energy;
    integrator->fixed[sums + DYNAMICS_DISSIPATED] = tolerance * energy;
    integrator->fixed[sums + DYNAMICS_FRICTION] = tolerance * energy;
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
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        motions[i] = scenario->linkage.bodies[i].start;
    }
    double y[DOP853_SIZE_MAX] = {0.0};
    tree_coordinates(&stepper->dynamics.tree, motions, y, y + n);
    loops_project(&stepper->dynamics.tree, 0.0, y, y + n);
    Dop853 *integrator = &stepper->integrator;
    integrator->size = dynamics_size(&stepper->dynamics);
    integrator->rates = dynamics_rates;
    integrator->context = &stepper->dynamics;
    set_tolerances(stepper);
    // the first step finds its own length: a thousandth of the run is long enough to be shortened
    integrator->step = 1e-3 * stepper->duration_s;
    stepper->onset_step = integrator->step;
    tree_rebase(&stepper->dynamics.tree, 0.0, y);
    dop853_start(integrator, 0.0, y);
    if (!dynamics_evaluate(&stepper->dynamics, 0.0, y, &stepper->points.states[0])) {
        return err_set(err, ERR_SOLVER, "the accelerations at the start are not determined");
    }
    return true;
}

// Makes the end of the last step the start of the next, with the event there.
static void take_over(Stepper *stepper)
{
    Dop853 *integrator = &stepper->integrator;
    Tree *tree = &stepper->dynamics.tree;
    const size_t n = tree->coordinate_count;
    dop853_accept(integrator);
    if (tree->loop_count > 0) {
        loops_project(tree, integrator->time, integrator->y, integrator->y + n);
    }
    tree_rebase(tree, integrator->time, integrator->y);
    if (stepper->event.is_present) {
        events_apply(&stepper->dynamics, &stepper->event, integrator->time, integrator->y);
        if (stepper->event.mode == CONTACT_PRESSING) {
            integrator->step = fmin(integrator->step, stepper->onset_step);
        }
    }
    if (tree->loop_count > 0 || stepper->event.is_present) {
        dop853_start(integrator, integrator->time, integrator->y);
    }
}

// Tries and fills one step, shortened to the next event.
static bool step_to_event(Stepper *stepper, Err *err)
{
    const Dynamics *dynamics = &stepper->dynamics;
    Dop853 *integrator = &stepper->integrator;
    if (!dop853_attempt(integrator, stepper->duration_s - integrator->time)) {
        return err_set(err, ERR_SOLVER,
                       "the step fell below the rounding of time: the motion cannot be followed "
                       "at a tolerance of %g",
                       stepper->scenario->reference.tolerance);
    }
    dop853_fill(integrator);
    bool is_determined = events_look(dynamics, integrator, &stepper->points);
    if (is_determined) {
        stepper->event = events_find(dynamics, integrator, &stepper->points);
        if (stepper->event.is_present) {
            events_land(dynamics, integrator, &stepper->event);
            is_determined = events_look(dynamics, integrator, &stepper->points);
        }
    }
    return is_determined || err_set(err, ERR_SOLVER, "the accelerations are not determined");
}

bool stepper_next(Stepper *stepper, Err *err)
{
    Dop853 *integrator = &stepper->integrator;
    for (int standstills = 0; standstills <= STANDSTILL_MAX; standstills++) {
        bool is_onset = false;
        if (stepper->has_step) {
            is_onset = stepper->event.is_present && stepper->event.mode == CONTACT_PRESSING;
            take_over(stepper);
        }
        if (!step_to_event(stepper, err)) {
            return false;
        }
        stepper->has_step = true;
        if (is_onset && integrator->tried > 0.0) {
            stepper->onset_step = integrator->tried;
        }
        if (integrator->tried > 0.0) {
            return true;
        }
    }
    return err_set(err, ERR_SOLVER, "contacts begin and end without end at one instant");
}

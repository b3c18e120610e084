// How does the motion get from one event to the next?
//
// Errors are allowed relative to the speed of the fastest point of the mechanism: tolerance times
// that in the speed of each body's furthest joint, and that times the step in each coordinate, so
// that a penetration of a micron in a linkage of half a metre keeps its digits, however far a body
// is from the pivot that it turns about. Work and losses are allowed the tolerance times m v^2.
#include "reference/stepper.h"

#include "reference/plane_system.h"
#include "reference/space_system.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
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

static const SystemState *state_at_end(const Stepper *stepper)
{
    return stepper->points.states[stepper->points.count - 1];
}

// Lets the sizes of errors follow the largest speeds so far.
static void set_tolerances(Stepper *stepper)
{
    const System *system = stepper->system;
    const size_t n = system->coordinate_count;
    const double tolerance = options_reference_tolerance(&stepper->scenario->reference);
    const SpeedScale *scale = &stepper->scale;
    const double moving = MOVING_SHARE * tolerance * scale->moving;
    Dop853 *integrator = &stepper->integrator;
    for (size_t i = 0; i < n; i++) {
        const int body = system->coordinates[i].turning;
        const double allowed = body < 0 ? moving : TURNING_SHARE * tolerance * scale->turning[body];
        integrator->fixed[n + i] = allowed;
        integrator->grown[i] = POSITION_SHARE * allowed;
    }
    // the bodies' mean speed is some tenth of the largest scale, and work goes to and fro
    const double energy_share = 3e-2;
    double mass = 0.0;
    for (size_t i = 0; i < stepper->scenario->linkage.body_count; i++) {
        mass += stepper->scenario->linkage.bodies[i].mass;
    }
    double *sums = integrator->fixed + system_sum_index(system, 0);
    sums[SYSTEM_DRIVE_WORK] = energy_share * mass * moving * scale->moving;
    sums[SYSTEM_DISSIPATED] = energy_share * mass * moving * scale->moving;
    sums[SYSTEM_FRICTION] = energy_share * mass * moving * scale->moving;
    for (size_t i = 0; i < system->contact_count; i++) {
        sums[SYSTEM_IMPULSES + i] = mass * moving * system->contacts[i].arm;
    }
}

// Allows the errors that no step can avoid: rounding of a pin's position in its hole, times the
// stiffness that it presses on there, is a force, and the rates feel it for as long as the step.
static void allow_rounding(Stepper *stepper)
{
    const System *system = stepper->system;
    const SystemState *state = state_at_end(stepper);
    const size_t n = system->coordinate_count;
    double *fixed = stepper->integrator.fixed;
    double *grown = stepper->integrator.grown;
    double *sums = grown + system_sum_index(system, 0);
    const bool is_stiff = stepper->integrator.method != NULL;
    double force = 0.0;
    double damped = 0.0;
    double moved = 0.0;
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        const double rounding = ROUNDING * contact->clearance;
        // a contact that rounding alone keeps from its end is continued below zero depth
        const double depth = fmax(fabs(state->contacts[i].depth), rounding);
        if (contact->mode == CONTACT_PRESSING) {
            force += rounding * force_law_tangent(&contact->law, depth);
            damped += ROUNDING * stepper->scale.moving *
                      press_damping(contact, &state->contacts[i]) / (contact->arm * contact->arm);
        }
        moved = moved > 0.0 ? fmin(moved, rounding) : rounding;
        sums[SYSTEM_IMPULSES + i] = (force + (is_stiff ? damped : 0.0)) * contact->arm;
    }
    for (size_t i = 0; i < n; i++) {
        const SystemCoordinate *coordinate = &system->coordinates[i];
        grown[n + i] = force * coordinate->reach / coordinate->inertia;
        fixed[i] = moved / coordinate->reach;
    }
    force += is_stiff ? damped : 0.0;
    sums[SYSTEM_DRIVE_WORK] = force * stepper->scale.moving;
    sums[SYSTEM_DISSIPATED] = force * stepper->scale.moving;
    sums[SYSTEM_FRICTION] = force * stepper->scale.moving;
}

// Raises the scale where a body has become faster than any before.
static void follow_speeds(Stepper *stepper)
{
    const System *system = stepper->system;
    const double moving = system->kind->fastest(system, state_at_end(stepper));
    if (scale_raise(&stepper->scenario->linkage, moving, &stepper->scale)) {
        set_tolerances(stepper);
    }
}

bool stepper_init(Stepper *stepper, const Scenario *scenario, Err *err)
{
    memset(stepper, 0, sizeof *stepper);
    stepper->scenario = scenario;
    stepper->duration_s = scenario_duration(scenario);
    stepper->system = scenario->linkage.is_spatial ? space_system_create(scenario, err)
                                                   : plane_system_create(scenario, err);
    if (stepper->system == NULL) {
        return false;
    }
    System *system = stepper->system;
    Dop853 *integrator = &stepper->integrator;
    system_find_needs(system);
    dop853_init(integrator, system_size(system), system_sum_index(system, 0));
    stepper->events.events = calloc(system->contact_count + 1, sizeof(Event));
    stepper->found.events = calloc(system->contact_count + 1, sizeof(Event));
    assert(stepper->events.events != NULL && stepper->found.events != NULL);
    system->kind->start(system, integrator->y);
    integrator->rates = system->kind->rates;
    integrator->slopes = system->kind->slopes;
    integrator->coupling = system->coupling;
    integrator->context = system;
    stepper->scale = scale_speeds(scenario);
    set_tolerances(stepper);
    // the first step finds its own length: a thousandth of the run is long enough to be shortened
    integrator->step = 1e-3 * stepper->duration_s;
    stepper->onset_step = integrator->step;
    stepper->ending = ending_start();
    dop853_start(integrator, 0.0, integrator->y);
    for (size_t i = 0; i < EVENTS_POINTS_MAX; i++) {
        stepper->points.states[i] = system_state_create(system);
    }
    stepper->points.count = 1;
    if (!system->kind->evaluate(system, 0.0, integrator->y, stepper->points.states[0], NULL)) {
        return pace_undetermined(err);
    }
    return true;
}

void stepper_finish(Stepper *stepper)
{
    stiffness_finish(&stepper->stiffness);
    scale_free(&stepper->scale);
    for (size_t i = 0; i < EVENTS_POINTS_MAX; i++) {
        free(stepper->points.states[i]);
    }
    free(stepper->events.events);
    free(stepper->found.events);
    dop853_finish(&stepper->integrator);
    if (stepper->system != NULL) {
        system_free_needs(stepper->system);
        stepper->system->kind->destroy(stepper->system);
    }
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

static bool is_flight(const System *system)
{
    for (size_t i = 0; i < system->contact_count; i++) {
        if (system->contacts[i].mode == CONTACT_PRESSING) {
            return false;
        }
    }
    return true;
}

// Changes what the contacts do at the end of the last step, and with it how long the next may be:
// one of a flight as the last flight's, one of a contact as the first of the last contact.
static void apply_events(Stepper *stepper)
{
    Dop853 *integrator = &stepper->integrator;
    System *system = stepper->system;
    const bool was_flight = is_flight(system);
    events_apply(system, &stepper->events, integrator->time, integrator->y);
    if (was_flight) {
        stepper->flight_step = integrator->step;
    } else if (is_flight(system)) {
        integrator->step = fmax(integrator->step, stepper->flight_step);
    }
    if (is_onset(stepper)) {
        integrator->step = fmin(integrator->step, stepper->onset_step);
    }
}

// Makes the end of the last step the start of the next, with the events there.
static void take_over(Stepper *stepper)
{
    Dop853 *integrator = &stepper->integrator;
    System *system = stepper->system;
    follow_speeds(stepper);
    allow_rounding(stepper);
    const double taken_s = integrator->tried;
    dop853_accept(integrator);
    // time and coordinates count from here on
    const bool is_other = system->kind->rebase(system, integrator->time, integrator->y);
    integrator->time = 0.0;
    integrator->shortest = SHORTEST * system->kind->time(system, 0.0);
    if (stepper->events.count > 0) {
        apply_events(stepper);
    }
    if (is_other || stepper->events.count > 0) {
        dop853_start(integrator, integrator->time, integrator->y);
    }
    stiffness_follow(&stepper->stiffness, system, state_at_end(stepper), &stepper->scale, taken_s,
                     stepper->events.count > 0, integrator);
}

// The longest step to the end of the run, or to where a torque or a speed over time bends: across
// it the rates are not smooth.
static double smooth_limit(const Stepper *stepper)
{
    const System *system = stepper->system;
    const Linkage *linkage = &stepper->scenario->linkage;
    const double time_s = system->kind->time(system, 0.0);
    const double least_s = SHORTEST * time_s; // a bend nearer than this has been reached
    const double bend_s = fmin(time_table_next_bend(&linkage->torque.table, time_s + least_s),
                               drive_next_kink(&linkage->driver, time_s + least_s));
    return fmin(stepper->duration_s, bend_s) - time_s;
}

// The longest step in which no free pin crosses more than its play, nor a stop more than its size:
// error control alone lets a free
// flight, which it integrates exactly, be as long as it likes.
static double flight_limit(const Stepper *stepper)
{
    const System *system = stepper->system;
    double limit = smooth_limit(stepper);
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        // what presses at one end of a coordinate says how long steps are
        if (contact->mode == CONTACT_PRESSING ||
            (contact + contact->partner)->mode == CONTACT_PRESSING) {
            continue;
        }
        const double speed = system->kind->crossing(system, state_at_end(stepper), i);
        limit = speed > 0.0 ? fmin(limit, contact->flight / speed) : limit;
    }
    return limit;
}

// Why a step came to nothing: a pin past the end of its law, or a motion too rough to follow.
static bool fail_to_step(const Stepper *stepper, Err *err)
{
    const Dop853 *integrator = &stepper->integrator;
    const System *system = stepper->system;
    SystemState *state = stepper->points.states[0];
    if (!system->kind->evaluate(system, integrator->time, integrator->y, state, NULL)) {
        return pace_undetermined(err);
    }
    if (!system_check_depth(system, state, NEARLY, err)) {
        return false;
    }
    return err_set(err, ERR_SOLVER,
                   "the step fell below the rounding of time: the motion cannot be integrated at a "
                   "tolerance of %g; raise reference.tolerance",
                   options_reference_tolerance(&stepper->scenario->reference));
}

// Tries one step, as long as its error and what it may not pass allow.
static bool attempt(Stepper *stepper)
{
    Dop853 *integrator = &stepper->integrator;
    const size_t rejected = integrator->rejected;
    const double limit_s =
        ending_limit(&stepper->ending, stepper->system, state_at_end(stepper), integrator);
    const bool is_taken = dop853_attempt(integrator, fmin(limit_s, flight_limit(stepper)));
    ending_note(&stepper->ending, integrator->rejected > rejected);
    return is_taken;
}

// Tries one step, shortened to the first event in it.
static bool step_to_event(Stepper *stepper, Err *err)
{
    const System *system = stepper->system;
    Dop853 *integrator = &stepper->integrator;
    if (!attempt(stepper)) {
        return fail_to_step(stepper, err);
    }
    const double same_s = SAME * integrator->tried;
    Event landed = {.time = INFINITY};
    stepper->events.count = 0;
    for (size_t i = 0; i <= system->contact_count; i++) {
        if (!events_look(system, integrator, &stepper->points)) {
            return pace_undetermined(err);
        }
        // a shorter step sees better: it may show an event before the one it was cut to
        events_find(system, integrator, &stepper->points, &stepper->found);
        const Event *first = events_first(&stepper->found);
        if (first == NULL || first->time >= landed.time - SAME * integrator->tried) {
            break;
        }
        landed = *first;
        events_land(system, integrator, &landed);
        const EventList kept = stepper->events;
        stepper->events = stepper->found;
        stepper->found = kept;
    }
    if (integrator->method != NULL) {
        // it begins its next step with this one's polynomial
        dop853_fill(integrator);
    }
    if (stepper->events.count > 0) {
        events_gather(system, integrator, &stepper->points, &landed, same_s, &stepper->events);
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
            if (stepper->system->is_astray) {
                return pace_astray(err);
            }
            if (stepper->system->torn >= 0) {
                return pace_torn(stepper->system, err);
            }
        }
        const double time_s = stepper->system->kind->time(stepper->system, 0.0);
        if (!pace_keep(&stepper->pace, stepper->system, &stepper->events, time_s, err) ||
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

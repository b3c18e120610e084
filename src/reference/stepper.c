// Takes the motion step by step from one event to the next.
//
// Errors are allowed relative to the speed of the fastest point of the mechanism: tolerance times
// that in the speed of each body's furthest joint, and that times the step in each coordinate, so
// that a penetration of a micron in a linkage of half a metre keeps its digits, however far a body
// is from the pivot that it turns about. Work and losses are allowed the tolerance times m v^2.
#include "reference/stepper.h"

#include "kernel/friction_answer.h"
#include "model/forces.h"
#include "model/loads.h"
#include "model/space_flat.h"
#include "reference/system.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Ends a run whose steps or events pile up at one instant.
//
// Bounces of a pin follow one another ever faster, down to heights of rounding: some hundred of
// them at the end of 1e-8 s. A contact that is stiff or strongly damped needs steps of a share of
// its own time; of a usual one that is some ten thousand steps a turn. Both end by themselves.

// of a turn of the drive, or of a run without one
static const double PACE_INSTANT_SHARE = 1e-12;
static const double PACE_STEP_SHARE = 5e-8; // twenty million steps a turn: minutes each

enum { EVENTS_MOST = 1000, STEPS_COUNTED = 50000 };

// of a turn of the drive
static const double FIRST_STEP_SHARE = 1e-3;
static const double FIRST_STEP_S = 1e-5; // without one

static double pace_turn_of(const System *system)
{
    const Scenario *scenario = system->scenario;
    return drive_is_steady(&scenario->linkage.driver) ? linkage_period(&scenario->linkage)
                                                      : scenario_duration(scenario);
}

static const char *joint_name(const System *system, size_t contact)
{
    return system->scenario->linkage.joints[system->contacts[contact].joint].name;
}

static bool refuse_steps(const Pace *pace, const System *system, double time_s, Err *err)
{
    const double width_s = time_s - pace->since_s;
    for (size_t i = 0; i < system->contact_count; i++) {
        if (system->contacts[i].mode == CONTACT_PRESSING) {
            return err_set(
                err, ERR_SOLVER,
                "%d steps advanced the motion by only %.3g s: the contact of %s is too stiff "
                "or too strongly damped; use a higher restitution, another damping or a "
                "lower stiffness",
                STEPS_COUNTED, width_s, joint_name(system, i));
        }
    }
    return err_set(
        err, ERR_SOLVER, "%d steps advanced the motion by only %.3g s%s", STEPS_COUNTED, width_s,
        forces_any(&system->scenario->linkage) ? ": a spring or a damper is too strong; lower it"
                                               : "");
}

// What keeps changing. Returns false, with ERR_SOLVER.
static bool refuse_events(const Pace *pace, const System *system, const Event *event, double time_s,
                          Err *err)
{
    const double within_s = time_s - pace->instant_s;
    if (event->is_drive) {
        return err_set(err, ERR_SOLVER,
                       "the torque of the drive keeps reaching and leaving its limit: %zu changes "
                       "within %.3g s",
                       pace->events, within_s);
    }
    const char *name =
        event->is_bristle
            ? system->scenario->linkage.joints[system->bristles[event->contact].joint].name
            : joint_name(system, event->contact);
    return err_set(err, ERR_SOLVER,
                   "the %s of %s keeps beginning and ending: %zu changes within %.3g s",
                   event->is_bristle ? "friction" : "contact", name, pace->events, within_s);
}

bool pace_keep(Pace *pace, const System *system, const EventList *events, double time_s, Err *err)
{
    const double turn_s = pace_turn_of(system);
    if (time_s - pace->instant_s > PACE_INSTANT_SHARE * turn_s) {
        pace->instant_s = time_s;
        pace->events = 0;
    }
    pace->events += events->count;
    const bool has_limit = system->scenario->linkage.torque.limit > 0.0;
    const size_t parts = system->contact_count + system->bristle_count + (has_limit ? 1 : 0);
    if (pace->events > EVENTS_MOST * parts) {
        return refuse_events(pace, system, &events->events[0], time_s, err);
    }
    pace->steps++;
    if (pace->steps == STEPS_COUNTED) {
        if (time_s - pace->since_s < PACE_STEP_SHARE * STEPS_COUNTED * turn_s) {
            return refuse_steps(pace, system, time_s, err);
        }
        pace->steps = 0;
        pace->since_s = time_s;
    }
    return true;
}

// An ideal joint cannot be kept closed. Returns false, with ERR_SOLVER.
static bool pace_astray(Err *err)
{
    return err_set(err, ERR_SOLVER,
                   "the energy is not kept where the ideal joints pass a change point, at which "
                   "they do not determine how the motion continues; give one of them play, or a "
                   "looser reference.tolerance");
}

static bool pace_torn(const System *system, Err *err)
{
    return err_set(err, ERR_SOLVER,
                   "the ideal joint %s cannot be kept closed: the loop that it closes is locked; "
                   "give one of its joints play, or let its lengths and axes fit",
                   system->scenario->linkage.joints[system->torn].name);
}

bool pace_undetermined(const System *system, Err *err)
{
    const int jammed = system->kind->jammed != NULL ? system->kind->jammed(system) : -1;
    if (jammed >= 0) {
        return friction_answer_refuse(system->scenario->linkage.joints[jammed].name, err);
    }
    return err_set(err, ERR_SOLVER,
                   "the accelerations are not determined: the ideal joints stand at a change "
                   "point, or are redundant; give one of them play, or start elsewhere");
}

// Limits the step in which a contact is about to end.
//
// Where a contact ends, its force has a corner, as of d^n, and no formula is of its order across
// it. With depth d, its rate d' < 0 and second rate d'', the contact ends after
//     t = 2 d / (-d' + sqrt(d'^2 - 2 d d'')),
// or not at all where the root is of a negative number. What the corner costs grows with the
// impulse that is still to come, F t. Steps keep to a share of t until that is small enough to be
// crossed: as small as one was that has been crossed before.

// Of the step that the errors so far allow: an end that is nearer is worth a limit, and one that
// is nearer than the second number is rounding.
static const double ENDING_STEP_SHARE = 0.9;
static const double ENDING_ROUNDING_SHARE = 1e-6;

// Of the time to the end: so that it is crossed, and so that it is not. Measured, shares of 0.6 to
// 0.85 cost the same to one in a hundred.
static const double ENDING_CROSSED_SHARE = 1.05;
static const double ENDING_AVOIDED_SHARE = 0.7;

// How what can be crossed changes where an end was crossed, and where it could not be.
static const double ENDING_GROWTH = 2.0;
static const double ENDING_DECAY = 0.25;

// of the step: over which the second rate is found
static const double ENDING_DIFFERENCE_SHARE = 1e-3;

// Where nothing has been seen yet.
static Ending ending_start(void)
{
    return (Ending){.crossed = INFINITY, .size = -1.0};
}

// The second rate of a depth.
static double second_rate(const System *system, size_t contact, double closing,
                          const Dop853 *integrator)
{
    const double little_s = ENDING_DIFFERENCE_SHARE * integrator->step;
    double *y = integrator->at;
    for (size_t i = 0; i < integrator->size; i++) {
        y[i] = integrator->y[i] + little_s * integrator->stages[0][i];
    }
    const Press later = system->kind->press(system, contact, integrator->time + little_s, y);
    return (later.closing - closing) / little_s;
}

// The time after which a contact ends, if that is below a limit; infinite otherwise.
static double time_left(const System *system, size_t contact, const Press *press,
                        const Dop853 *integrator, double limit_s)
{
    const double speed = -press->closing;
    const bool is_pressing = system->contacts[contact].mode == CONTACT_PRESSING;
    // no acceleration makes it less than half of what the speed alone says, but one that grows
    if (!is_pressing || !(speed > 0.0 && press->depth > 0.0) ||
        press->depth > 2.0 * limit_s * speed) {
        return INFINITY;
    }
    const double second = second_rate(system, contact, press->closing, integrator);
    const double square = speed * speed - 2.0 * press->depth * second;
    const double left_s = square > 0.0 ? 2.0 * press->depth / (speed + sqrt(square)) : INFINITY;
    return left_s < limit_s ? left_s : INFINITY;
}

// The longest step from a state on, which is the integrator's, s; infinite where no contact ends
// soon. The integrator has the rates there, and its room for a state is used.
static double ending_limit(Ending *ending, const System *system, const SystemState *state,
                           const Dop853 *integrator)
{
    double least_s = integrator->step / ENDING_STEP_SHARE;
    double size = -1.0;
    ending->size = -1.0;
    for (size_t i = 0; integrator->method == NULL && i < system->contact_count; i++) {
        const Press *press = &state->contacts[i];
        const double left_s = time_left(system, i, press, integrator, least_s);
        if (left_s < least_s && left_s > ENDING_ROUNDING_SHARE * integrator->step) {
            least_s = left_s;
            size = press->elastic * left_s;
        }
    }
    if (size < 0.0) {
        return INFINITY;
    }
    if (size > ending->crossed) {
        return ENDING_AVOIDED_SHARE * least_s;
    }
    ending->size = size;
    return ENDING_CROSSED_SHARE * least_s;
}

// Takes note of whether the step was refused.
static void ending_note(Ending *ending, bool is_refused)
{
    if (ending->size >= 0.0) {
        ending->crossed = is_refused ? ENDING_DECAY * ending->size
                                     : fmax(ending->crossed, ENDING_GROWTH * ending->size);
    }
}

// Chooses the method that takes the next step.
//
// Rates die away in a contact of damping c with the time constant m / c. The explicit method is
// held to steps of some three of them, however smooth the motion is. The measure of it is the
// largest eigenvalue of -dA/du. Their sum would not do: of several contacts, none of which holds
// steps back, it had the implicit method take over at a multiple of the work.
//
// At a small tolerance steps are shorter still: the accelerations at the stages, which are of low
// order, err by c / m of the stages' speeds. Of a contact that does not oscillate for long,
//     (c / 2 sqrt(k m))^2 = (c / m) (c / k) / 4  >  1 / 4
// that costs many times the steps that the motion needs. No rate tells by how many: the implicit
// method is put on trial, and stays where its steps are longer by more than they cost. (Trials of
// contacts that do oscillate cost up to a tenth of the work and win nothing.)

enum { STIFFNESS_CHECK_INTERVAL = 32 }; // explicit steps

// Steps times the largest rate of decay. Above the first the explicit method is held back,
// below the second it takes the same steps for a fifth of the work.
static const double STIFFNESS_LIMITED = 2.5;
static const double STIFFNESS_UNLIMITED = 0.5;

// A trial costs the work of some steps. It is worth while from these on, of a contact by itself:
// steps times its rate of decay, and that rate times c / k.
static const double STIFFNESS_TRIAL_DECAY = 0.02;
static const double STIFFNESS_TRIAL_DAMPING = 1.0;

// An implicit step of few coordinates takes the work of some eight explicit ones. Of a row of
// four-bars, where all coordinates depend on one another, it takes that of a hundred, so that no
// rate of decay tells whether it is worth it. Above so many explicit steps, with more coordinates
// than three loose bodies have, the implicit method is always put on trial.
static const double STIFFNESS_STEP_COST = 8.0;
static const double STIFFNESS_COST_MUCH = 40.0;
enum { STIFFNESS_COORDINATES_FEW = 9 };

// A trial follows when explicit steps that were held back have taken some times its work. After it
// each implicit step is held against the explicit ones that it has beaten, which are as long as the
// decay lets them be: one that is worth less than the share of its work counts against the method,
// which is left when that comes to so many steps; in its favour no more than as many count.
static const double STIFFNESS_HELD = 4.0;
static const double STIFFNESS_LEAVE = 0.5;
static const double STIFFNESS_GAIN_MOST = 2.0;

// What accelerations are differentiated by: of the fastest speed, and of a depth
static const double SPEED_SHARE = 1e-7;
static const double DEPTH_SHARE = 1e-3;

// The smallest depth that a force depends on in the next step, m; 0 where nothing presses.
static double smallest_depth(const System *system, const SystemState *state, double step)
{
    double smallest = 0.0;
    for (size_t i = 0; i < system->contact_count; i++) {
        const Press *press = &state->contacts[i];
        if (system->contacts[i].mode == CONTACT_PRESSING) {
            const double depth =
                (fabs(press->depth) + step * fabs(press->closing)) * system->contacts[i].arm;
            smallest = smallest > 0.0 ? fmin(smallest, depth) : depth;
        }
    }
    return smallest;
}

static void set_nudges(const System *system, const SpeedScale *scale, double depth, double *nudge)
{
    const size_t n = system->coordinate_count;
    for (size_t i = 0; i < n; i++) {
        const int body = system->coordinates[i].turning;
        const double moved = DEPTH_SHARE * depth;
        nudge[i] = body < 0 ? moved : moved * scale->turning[body] / scale->moving;
        nudge[n + i] = SPEED_SHARE * (body < 0 ? scale->moving : scale->turning[body]);
    }
}

// Whether the damping of the contacts outweighs their springs by so much that explicit steps may be
// far shorter than need be.
static bool is_doubtful(const System *system, const SystemState *state, double step, double decay)
{
    double relaxation_s = 0.0; // the longest time in which a spring moves its damper
    for (size_t i = 0; i < system->contact_count; i++) {
        const Contact *contact = &system->contacts[i];
        const double depth = fabs(state->contacts[i].depth);
        const double stiffness = force_law_tangent(&contact->law, depth);
        if (contact->mode == CONTACT_PRESSING) {
            const double damping = press_damping(contact, &state->contacts[i]);
            relaxation_s = stiffness > 0.0 ? fmax(relaxation_s, damping / stiffness) : relaxation_s;
        }
    }
    return step * decay > STIFFNESS_TRIAL_DECAY && decay * relaxation_s > STIFFNESS_TRIAL_DAMPING;
}

// Puts the implicit method on trial, with a step that is longer by more than it costs.
static bool begin_trial(Stiffness *stiffness, double cost, Dop853 *integrator)
{
    stiffness->beaten_s = integrator->step;
    integrator->step *= 2.0 * cost;
    return true;
}

// The same where a trial costs much.
static bool takes_over_at_cost(Stiffness *stiffness, bool is_held, Dop853 *integrator)
{
    stiffness->held += is_held ? STIFFNESS_CHECK_INTERVAL : 0.0;
    if (!is_held || stiffness->held < STIFFNESS_HELD * stiffness->cost) {
        return false;
    }
    stiffness->held = 0.0;
    stiffness->gain = 0.0;
    stiffness->beaten_decay = integrator->step * stiffness->radau->decay;
    return begin_trial(stiffness, stiffness->cost, integrator);
}

// Whether the implicit method takes over from the explicit one, or is put on trial.
static bool takes_over(Stiffness *stiffness, const System *system, const SystemState *state,
                       Dop853 *integrator)
{
    const double decay = stiffness->radau->decay;
    const bool is_limited = integrator->step * decay > STIFFNESS_LIMITED;
    const bool is_held = is_limited || is_doubtful(system, state, integrator->step, decay);
    stiffness->cost = radau_step_cost(stiffness->radau);
    if (system->coordinate_count <= STIFFNESS_COORDINATES_FEW) {
        stiffness->cost = STIFFNESS_STEP_COST;
    }
    if (stiffness->cost > STIFFNESS_COST_MUCH) {
        return takes_over_at_cost(stiffness, is_held, integrator);
    }
    if (is_limited || !is_held) {
        return is_limited;
    }
    if (stiffness->wait > 0) {
        stiffness->wait--;
        return false;
    }
    return begin_trial(stiffness, STIFFNESS_STEP_COST, integrator);
}

// Whether implicit steps, of which one has just been taken, have been worth what they cost.
static bool is_worth(Stiffness *stiffness, double taken_s)
{
    const double explicit_s = stiffness->beaten_decay / stiffness->radau->decay;
    const double worth = taken_s / (stiffness->cost * explicit_s);
    stiffness->gain = fmin(stiffness->gain + worth - STIFFNESS_LEAVE, STIFFNESS_GAIN_MOST);
    return stiffness->gain > -STIFFNESS_GAIN_MOST;
}

// Whether the implicit method stays: after a trial where its step was worth it.
static bool stays(Stiffness *stiffness, double taken_s, Dop853 *integrator)
{
    const double beaten_s = stiffness->beaten_s;
    stiffness->beaten_s = 0.0;
    const bool costs_much = stiffness->cost > STIFFNESS_COST_MUCH;
    if (beaten_s == 0.0 && costs_much) {
        return is_worth(stiffness, taken_s);
    }
    if (beaten_s == 0.0) {
        return integrator->step * stiffness->radau->decay > STIFFNESS_UNLIMITED;
    }
    if (taken_s > (costs_much ? stiffness->cost : STIFFNESS_STEP_COST) * beaten_s) {
        stiffness->pause = 0;
        return true;
    }
    integrator->step = beaten_s;
    // the next trials come at ever longer intervals
    stiffness->pause = 2 * stiffness->pause + 1;
    stiffness->wait = stiffness->pause;
    return false;
}

// To be called before each step, whether an event has come at its start or not, with the length of
// the step before it, s; the integrator stands at the state. Sets the method.
static void stiffness_follow(Stiffness *stiffness, const System *system, const SystemState *state,
                             const SpeedScale *scale, double taken_s, bool is_event,
                             Dop853 *integrator)
{
    const double depth = smallest_depth(system, state, integrator->step);
    if (system->bristle_count > 0) {
        return; // the implicit method knows no bends
    }
    const bool is_implicit = integrator->method != NULL;
    // of many coordinates events follow one another at once
    const bool starts_anew = is_event && system->coordinate_count <= STIFFNESS_COORDINATES_FEW;
    stiffness->steps = starts_anew ? 0 : stiffness->steps + 1;
    if (is_event || !(depth > 0.0)) {
        stiffness->beaten_s = 0.0;
        stiffness->wait = stiffness->pause = 0;
    }
    if (!(depth > 0.0)) {
        integrator->method = NULL;
        return;
    }
    if (!is_implicit) {
        stiffness->beaten_s = 0.0;
    }
    if (!is_implicit && stiffness->steps < STIFFNESS_CHECK_INTERVAL) {
        return;
    }
    stiffness->steps = 0;
    if (stiffness->radau == NULL) {
        stiffness->radau = radau_create(integrator);
    }
    Radau *radau = stiffness->radau;
    set_nudges(system, scale, depth, radau->nudge);
    if (!is_implicit || is_event) {
        radau_find_decay(radau, integrator);
    }
    const bool is_next = is_implicit ? stays(stiffness, taken_s, integrator)
                                     : takes_over(stiffness, system, state, integrator);
    integrator->method = is_next ? &radau->method : NULL;
    integrator->method_least = 0.0;
    if (is_next && stiffness->beaten_s > 0.0 && stiffness->cost > STIFFNESS_COST_MUCH) {
        integrator->otherwise = stiffness->beaten_s;
        integrator->method_least = stiffness->cost * stiffness->beaten_s;
    }
}

static void stiffness_finish(Stiffness *stiffness)
{
    radau_destroy(stiffness->radau);
}

// of a step: two events nearer to each other than this are one, seen with rounding
static const double SIMULTANEOUS_SHARE = 1e-9;

// of the deepest penetration a law knows: a pin that cannot be followed beyond it is at its end
static const double DEPTH_LIMIT_SHARE = 0.99;

// Shares of a tolerance that speeds of centres and of furthest joints have: measured, a four-bar
// with two loose joints then errs by some forty times its tolerance
static const double MOVING_SHARE = 1.2;
static const double TURNING_SHARE = 0.6;

// The error allowed in positions, over that in rates times the step: measured on the paper's
// mechanism, an error of 1e-9 costs a fifth less than at 1, and no less from 8 to 32.
static const double POSITION_SHARE = 16.0;

// 1: eight times the rounding of a number, for an estimate of the error that sees as much as it
// allows lets no step grow
static const double TOLERANCE_LEAST_SHARE = 0x1p-50;

// of the time: below this, rounding of the time would show in a step
static const double STEP_SHORTEST_SHARE = 16.0 * DBL_EPSILON;

static const SystemState *state_at_end(const Stepper *stepper)
{
    return stepper->points.states[stepper->points.count - 1];
}

// Lets the sizes of errors follow the largest speeds so far.
static void set_tolerances(Stepper *stepper)
{
    const System *system = stepper->system;
    const size_t n = system->coordinate_count;
    const double tolerance = stepper->system->tolerance;
    const SpeedScale *scale = &stepper->scale;
    const double moving = MOVING_SHARE * tolerance * scale->moving;
    Dop853 *integrator = &stepper->integrator;
    for (size_t i = 0; i < n; i++) {
        const int body = system->coordinates[i].turning;
        const double allowed = body < 0 ? moving : TURNING_SHARE * tolerance * scale->turning[body];
        integrator->fixed[n + i] = allowed;
        integrator->grown[i] = POSITION_SHARE * allowed;
    }
    for (size_t i = 0; i < system->bristle_count; i++) {
        const size_t bend = system_bristle_index(system, i);
        integrator->fixed[bend] = tolerance * system->bristles[i].pair.limit;
        integrator->grown[bend] = POSITION_SHARE * moving;
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
    if (system->has_loads) {
        sums[system_load_sum(system)] = sums[SYSTEM_DRIVE_WORK];
    }
}

// Allows the errors that no step can avoid: rounding of a pin's position in its hole, times the
// stiffness that it presses on there, is a force, and the rates have it for as long as the step.
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
        const double rounding = TOLERANCE_LEAST_SHARE * contact->clearance;
        // a contact that rounding alone keeps from its end is continued below zero depth
        const double depth = fmax(fabs(state->contacts[i].depth), rounding);
        if (contact->mode == CONTACT_PRESSING) {
            force += rounding * force_law_tangent(&contact->law, depth);
            damped += TOLERANCE_LEAST_SHARE * stepper->scale.moving *
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
    if (system->has_loads) {
        sums[system_load_sum(system)] = force * stepper->scale.moving;
    }
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

// Notes which contacts have moved out of their walls.
static void follow_releases(Stepper *stepper)
{
    System *system = stepper->system;
    const SystemState *end = state_at_end(stepper);
    for (size_t i = 0; i < system->contact_count; i++) {
        Contact *contact = &system->contacts[i];
        contact->is_released = contact->is_released ||
                               (contact->mode != CONTACT_APART && end->contacts[i].closing < 0.0);
    }
}

// The longest step that still sees a sinusoid which acts or drives: with two in each of its periods
// none passes for something slower.
static double wave_limit(const Linkage *linkage)
{
    const Torque *torque = &linkage->torque;
    double shortest_s = fmin(loads_shortest_wave(linkage), wave_period(&torque->table.wave));
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        shortest_s = fmin(shortest_s, wave_period(&linkage_drive(linkage, i)->table.wave));
    }
    if (torque->followed.is_present) {
        shortest_s = fmin(shortest_s, wave_period(&torque->followed.table.wave));
    }
    return 0.5 * shortest_s;
}

bool stepper_init(Stepper *stepper, const Scenario *scenario, Err *err)
{
    memset(stepper, 0, sizeof *stepper);
    stepper->scenario = scenario;
    stepper->duration_s = scenario_duration(scenario);
    stepper->wave_s = wave_limit(&scenario->linkage);
    stepper->system = !scenario->linkage.is_spatial ? plane_system_create(scenario, err)
                      : space_flat_is(scenario)     ? flat_system_create(scenario, err)
                                                    : space_system_create(scenario, err);
    if (stepper->system == NULL) {
        return false;
    }
    System *system = stepper->system;
    Dop853 *integrator = &stepper->integrator;
    system_find_needs(system);
    dop853_init(integrator, system_size(system), system_sum_index(system, 0));
    const size_t event_most = system->contact_count + system->bristle_count + 2;
    stepper->events.events = calloc(event_most, sizeof(Event));
    stepper->found.events = calloc(event_most, sizeof(Event));
    assert(stepper->events.events != NULL && stepper->found.events != NULL);
    system_take_contacts(system);
    system->kind->start(system, integrator->y);
    system_find_places(system, integrator->y);
    if (system->bristle_count > 0) {
        bristle_events_start(system, integrator->y);
    }
    drive_limit_start(system, integrator->y);
    integrator->rates = system->kind->rates;
    integrator->slopes = system->kind->slopes;
    integrator->coupling = system->coupling;
    integrator->context = system;
    stepper->scale = scale_speeds(scenario);
    set_tolerances(stepper);
    // The first step finds its own length: a thousandth of a turn is long enough to be shortened,
    // and a start without turns grows from ten microseconds in a few steps. The length of the run
    // has no part in it: what happens does not depend on how long one looks.
    integrator->step = drive_is_steady(&scenario->linkage.driver)
                           ? FIRST_STEP_SHARE * linkage_period(&scenario->linkage)
                           : FIRST_STEP_S;
    stepper->onset_step = integrator->step;
    stepper->ending = ending_start();
    dop853_start(integrator, 0.0, integrator->y);
    for (size_t i = 0; i < EVENTS_POINTS_MAX; i++) {
        stepper->points.states[i] = system_state_create(system);
    }
    stepper->points.count = 1;
    if (!system->kind->evaluate(system, 0.0, integrator->y, stepper->points.states[0], NULL)) {
        return pace_undetermined(system, err);
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

static void stiffness_carry(Stiffness *stiffness, Dop853 *integrator, Carry *carry)
{
    bool has_radau = stiffness->radau != NULL;
    bool is_implicit = integrator->method != NULL;
    CARRY(carry, has_radau);
    CARRY(carry, is_implicit);
    CARRY(carry, stiffness->steps);
    CARRY(carry, stiffness->beaten_s);
    CARRY(carry, stiffness->wait);
    CARRY(carry, stiffness->pause);
    CARRY(carry, stiffness->cost);
    CARRY(carry, stiffness->held);
    CARRY(carry, stiffness->beaten_decay);
    CARRY(carry, stiffness->gain);
    if (has_radau && stiffness->radau == NULL) {
        stiffness->radau = radau_create(integrator);
    }
    if (has_radau) {
        radau_carry(stiffness->radau, carry);
    }
    integrator->method = is_implicit ? &stiffness->radau->method : NULL;
}

void stepper_carry(Stepper *stepper, Carry *carry)
{
    System *system = stepper->system;
    Dop853 *integrator = &stepper->integrator;
    system_carry(system, carry);
    dop853_carry(integrator, carry);
    stiffness_carry(&stepper->stiffness, integrator, carry);
    scale_carry(&stepper->scenario->linkage, &stepper->scale, carry);
    CARRY(carry, stepper->points.count);
    CARRY(carry, stepper->events.count);
    CARRY_ARRAY(carry, stepper->events.events, stepper->events.count);
    CARRY(carry, stepper->pace);
    CARRY(carry, stepper->has_step);
    CARRY(carry, stepper->is_after_onset);
    CARRY(carry, stepper->onset_step);
    CARRY(carry, stepper->flight_step);
    CARRY(carry, stepper->ending);
    if (carry->is_back && stepper->has_step) {
        const double end_s =
            events_point_time(integrator, &stepper->points, stepper->points.count - 1);
        system->kind->evaluate(system, end_s, integrator->next,
                               stepper->points.states[stepper->points.count - 1], NULL);
    }
}

// Whether a contact begins to press at the end of the step.
static bool is_onset(const Stepper *stepper)
{
    for (size_t i = 0; i < stepper->events.count; i++) {
        const Event *event = &stepper->events.events[i];
        if (!event->is_bristle && event->mode == CONTACT_PRESSING && !event->is_rest &&
            !event->is_full && event->wall == WALL_NEAREST) {
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
    for (size_t i = 0; i < stepper->events.count; i++) {
        Event *event = &stepper->events.events[i];
        event->is_onset = !event->is_bristle && !event->is_drive &&
                          system->contacts[event->contact].mode == CONTACT_APART;
    }
    events_apply(system, &stepper->events, integrator->time, integrator->y);
    for (size_t i = 0; i < stepper->events.count; i++) {
        const Event *event = &stepper->events.events[i];
        if (event->is_bristle) {
            bristle_events_apply(system, event, integrator->y);
        } else if (event->is_onset) {
            bristle_events_onset(system, event->contact, integrator->y);
        }
    }
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
    follow_releases(stepper);
    allow_rounding(stepper);
    const double taken_s = integrator->tried;
    dop853_accept(integrator);
    // time and coordinates count from here on
    const bool is_other = system->kind->rebase(system, integrator->time, integrator->y);
    integrator->time = 0.0;
    integrator->shortest = STEP_SHORTEST_SHARE * system->kind->time(system, 0.0);
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
    const double least_s = STEP_SHORTEST_SHARE * time_s; // a bend nearer than this has been reached
    const double after_s = time_s + least_s;
    double bend_s = fmin(time_table_next_bend(&linkage->torque.table, after_s),
                         linkage_next_kink(linkage, after_s));
    bend_s = fmin(bend_s, loads_next_bend(linkage, after_s));
    bend_s = linkage->torque.followed.is_present
                 ? fmin(bend_s, drive_next_kink(&linkage->torque.followed, after_s))
                 : bend_s;
    return fmin(fmin(stepper->duration_s, bend_s) - time_s, stepper->wave_s);
}

// The longest step in which no free pin crosses more than its play, nor a stop more than its size:
// error control alone lets a free flight, which it integrates exactly, be as long as it likes.
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
        return pace_undetermined(system, err);
    }
    if (!system_check_depth(system, state, DEPTH_LIMIT_SHARE, err)) {
        return false;
    }
    return err_set(err, ERR_SOLVER,
                   "the step fell below the rounding of time: the motion cannot be integrated at a "
                   "tolerance of %g; raise reference.tolerance",
                   stepper->system->tolerance);
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
    const double same_s = SIMULTANEOUS_SHARE * integrator->tried;
    Event landed = {.time = INFINITY};
    stepper->events.count = 0;
    for (size_t i = 0; i <= system->contact_count + system->bristle_count; i++) {
        if (!events_evaluate(system, integrator, &stepper->points)) {
            return pace_undetermined(system, err);
        }
        // a shorter step sees better: it may show an event before the one it was cut to
        events_find(system, integrator, &stepper->points, &stepper->found);
        const Event *first = events_first(&stepper->found);
        if (first == NULL || first->time >= landed.time - SIMULTANEOUS_SHARE * integrator->tried) {
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

// Moves a four-bar or slider-crank with ideal joints in closed form, sample by sample: a solver.
//
// Its steps are the sample intervals, a degree of the crank at most. Play is ignored, so that with
// play the difference of another solver to this one is the effect of the play plus that solver's
// error.
#include "analytic/closed_form.h"
#include "analytic/driven_extremes.h"
#include "analytic/inverse_dynamics.h"
#include "model/joint_rows.h"
#include "model/loads.h"
#include "model/solver.h"
#include "model/space.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { JOINTS = 4 }; // of a four-bar and of a slider-crank

// A state at a time, with its arrays.
typedef struct Instant {
    Motion bodies[CLOSED_FORM_BODIES];
    JointState joints[JOINTS];
} Instant;

static Sample sample_of(Instant *instant)
{
    return (Sample){.bodies = instant->bodies, .joints = instant->joints};
}

typedef struct Analytic {
    const Scenario *scenario;
    double start_s;
    double end_s;
    size_t steps;
    Motion bodies[CLOSED_FORM_BODIES]; // at end_s, once there was a step
    double omega[CLOSED_FORM_BODIES];
    double alpha[CLOSED_FORM_BODIES];
    JointState joints[JOINTS];
    double torque;     // N m, of the drive at end_s
    double drive_work; // J, in the last step
    double load_work;  // likewise, of loads
    double damped;     // likewise, in dampers
    double impulse[JOINTS];
    double approach[JOINTS];
} Analytic;

static bool place_bodies(const Analytic *analytic, double from_s, Sample *sample)
{
    const Driver *driver = &analytic->scenario->linkage.driver;
    if (drive_is_steady(driver)) {
        return closed_form_bodies(analytic->scenario, sample->crank_rad, sample->bodies);
    }
    const DriveState drive = drive_since(driver, from_s, sample->time_s);
    return closed_form_driven(analytic->scenario, &drive, sample->bodies);
}

// The state at any time, angles in the turn of the principal value. Where the drive's speed has a
// kink it goes on as from the earlier time given.
static bool evaluate(const Analytic *analytic, double from_s, double time_s, Sample *sample,
                     double *torque, Err *err)
{
    const Linkage *linkage = &analytic->scenario->linkage;
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    if (!place_bodies(analytic, from_s, sample)) {
        return err_set(err, ERR_SOLVER, "at %.6g ms, crank angle %.6g deg: the %s does not close",
                       1e3 * time_s, sample->crank_rad * 180.0 / M_PI,
                       closed_form_name(analytic->scenario));
    }
    Reactions reactions;
    if (!inverse_dynamics_solve(linkage, sample->bodies, scenario_gravity(analytic->scenario),
                                (InverseTime){time_s, from_s}, &reactions, err)) {
        return false;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        sample->joints[i] = (JointState){
            .force_on_b = reactions.force_on_b[i],
            .force = vec2_length(reactions.force_on_b[i]),
            .moment_on_b = reactions.moment_on_b[i],
            .is_touching = true,
        };
        // a pin is at the centre of its hole, a slider somewhere along its line
        if (joint_rows_is_angle(linkage->joints[i].kind, 1)) {
            const Vec2 gap = linkage_joint_gap(linkage, sample->bodies, (int)i).position;
            const Vec2 along = joint_rows_along(linkage, sample->bodies, (int)i);
            sample->joints[i].eccentricity.x = vec2_dot(along, gap);
        }
    }
    *torque = reactions.drive_torques[0];
    return true;
}

static void analytic_close(void *state)
{
    free(state);
}

static bool analytic_open(const Scenario *scenario, void **state, Err *err)
{
    if (!scenario_has_closed_form(scenario)) {
        return err_set(err, ERR_SOLVER,
                       "the analytic solver is for four-bars and slider-cranks only");
    }
    Analytic *analytic = calloc(1, sizeof *analytic);
    assert(analytic != NULL);
    analytic->scenario = scenario;
    Instant at;
    Sample start = sample_of(&at);
    if (!evaluate(analytic, 0.0, 0.0, &start, &analytic->torque, err)) {
        analytic_close(analytic);
        return false;
    }
    memcpy(analytic->joints, start.joints, sizeof analytic->joints);
    *state = analytic;
    return true;
}

// Adds up work and impulses of a step by Simpson's rule: its error over a turn in samples of a
// tenth of a degree is 1e-12 of the work.
static void add_up(Analytic *analytic, const Motion *start, const Sample *middle,
                   double middle_torque, const Sample *end, double end_torque, double width_s)
{
    const Linkage *linkage = &analytic->scenario->linkage;
    const Driver *driver = &linkage->driver;
    if (drive_is_steady(driver)) {
        analytic->drive_work =
            driver->speed * width_s * (analytic->torque + 4.0 * middle_torque + end_torque) / 6.0;
    } else {
        const double first = drive_at(driver, analytic->end_s).omega;
        analytic->drive_work =
            width_s *
            (first * analytic->torque + 4.0 * middle->bodies[0].omega * middle_torque +
             end->bodies[0].omega * end_torque) /
            6.0;
    }
    const double start_s = analytic->end_s;
    analytic->load_work = width_s *
                          (loads_power(linkage, start, start_s, start_s) +
                           4.0 * loads_power(linkage, middle->bodies, middle->time_s, start_s) +
                           loads_power(linkage, end->bodies, end->time_s, start_s)) /
                          6.0;
    analytic->damped = width_s *
                       (forces_damping_power(linkage, start) +
                        4.0 * forces_damping_power(linkage, middle->bodies) +
                        forces_damping_power(linkage, end->bodies)) /
                       6.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        analytic->impulse[i] =
            width_s *
            (analytic->joints[i].force + 4.0 * middle->joints[i].force + end->joints[i].force) /
            6.0;
    }
}

// The forces after a kink of the drive's speed, or a step of a load: they jump there.
static bool start_piece(Analytic *analytic, Sample *start, Err *err)
{
    const Linkage *linkage = &analytic->scenario->linkage;
    if (drive_is_steady(&linkage->driver) && !forces_any(linkage)) {
        return true;
    }
    if (!evaluate(analytic, analytic->end_s, analytic->end_s, start, &analytic->torque, err)) {
        return false;
    }
    memcpy(analytic->joints, start->joints, sizeof analytic->joints);
    return true;
}

static bool analytic_step(void *state, double stop_s, Err *err)
{
    Analytic *analytic = state;
    // a degree of the crank at most: extremes of the forces stand between two samples, too
    const Driver *driver = &analytic->scenario->linkage.driver;
    const double degree_s = 2.0 * M_PI / fabs(driver->speed) / 360.0;
    const double start_s = analytic->end_s;
    const double bend_s = fmin(drive_next_kink(driver, start_s),
                               loads_next_bend(&analytic->scenario->linkage, start_s));
    stop_s = fmin(fmin(stop_s, start_s + degree_s), bend_s);
    Instant first;
    Instant halfway;
    Instant behind;
    Sample begin = sample_of(&first);
    Sample middle = sample_of(&halfway);
    Sample end = sample_of(&behind);
    double middle_torque;
    double end_torque;
    const double width_s = stop_s - start_s;
    if (!start_piece(analytic, &begin, err) ||
        !evaluate(analytic, start_s, start_s + 0.5 * width_s, &middle, &middle_torque, err) ||
        !evaluate(analytic, start_s, stop_s, &end, &end_torque, err)) {
        return false;
    }
    add_up(analytic, begin.bodies, &middle, middle_torque, &end, end_torque, width_s);
    for (size_t i = 0; i < CLOSED_FORM_BODIES; i++) {
        analytic->bodies[i] = end.bodies[i];
        analytic->omega[i] = end.bodies[i].omega;
        analytic->alpha[i] = end.bodies[i].alpha;
    }
    memcpy(analytic->joints, end.joints, sizeof analytic->joints);
    analytic->torque = end_torque;
    analytic->start_s = analytic->end_s;
    analytic->end_s = stop_s;
    analytic->steps++;
    return true;
}

static StepRecord analytic_record(const void *state)
{
    const Analytic *analytic = state;
    return (StepRecord){
        .start_s = analytic->start_s,
        .end_s = analytic->end_s,
        .omega = analytic->omega,
        .alpha = analytic->alpha,
        .joint_s = analytic->end_s,
        .joints = analytic->joints,
        .impulse = analytic->impulse,
        .drive_work = analytic->drive_work,
        .load_work = analytic->load_work,
        .dissipated = analytic->damped,
        .approach = analytic->approach,
    };
}

// The state at the end of the step is known: the step has evaluated the loop there.
static void observe_end(const Analytic *analytic, Sample *sample)
{
    const Linkage *linkage = &analytic->scenario->linkage;
    sample->time_s = analytic->end_s;
    sample->crank_rad = linkage_crank_angle(linkage, analytic->end_s);
    memcpy(sample->bodies, analytic->bodies, sizeof analytic->bodies);
    memcpy(sample->joints, analytic->joints, linkage->joint_count * sizeof *sample->joints);
}

static void analytic_observe(const void *state, double time_s, Sample *sample)
{
    const Analytic *analytic = state;
    const Linkage *linkage = &analytic->scenario->linkage;
    if (analytic->steps > 0 && time_s == analytic->end_s) {
        observe_end(analytic, sample);
    } else {
        Err err = {ERR_NONE, ""};
        // the step before has evaluated the loop at the end of this interval
        double torque;
        const bool is_closed = evaluate(analytic, analytic->start_s, time_s, sample, &torque, &err);
        assert(is_closed);
        (void)is_closed;
    }
    if (linkage->is_spatial) {
        space_lift(linkage, sample->bodies, sample->space_bodies);
        memset(sample->space_joints, 0, linkage->joint_count * sizeof *sample->space_joints);
    }
}

static SolverModel analytic_model(const void *state)
{
    const Analytic *analytic = state;
    SolverModel model = {.steps = analytic->steps};
    snprintf(model.label, sizeof model.label, "closed form, every joint ideal");
    return model;
}

static Extreme at_angle(const Linkage *linkage, double value, double crank)
{
    return (Extreme){value, (crank - linkage->driver.start) / linkage->driver.speed, crank};
}

static void analytic_extremes(const void *state, double from_s, BodyExtremes *bodies)
{
    const Analytic *analytic = state;
    const Linkage *linkage = &analytic->scenario->linkage;
    if (!drive_is_steady(&linkage->driver)) {
        for (size_t i = 1; i < CLOSED_FORM_BODIES; i++) {
            bodies[i] = driven_extremes(analytic->scenario, i, from_s, analytic->end_s);
        }
        return;
    }
    const double first = linkage_crank_angle(linkage, from_s);
    // the motion repeats every turn: its extremes stand in the first one of those
    const double run = linkage_crank_angle(linkage, analytic->end_s) - first;
    const double last = first + copysign(fmin(fabs(run), 2.0 * M_PI), run);
    for (size_t i = 1; i < CLOSED_FORM_BODIES; i++) {
        CurveExtreme rate;
        CurveExtreme change;
        closed_form_extremes(analytic->scenario, i, first, last, &rate, &change);
        // all of them, in the order of BODY_EXTREMES_LIST: none is 0 because it was left out
        bodies[i] = (BodyExtremes){
            at_angle(linkage, rate.high, rate.high_angle),
            at_angle(linkage, rate.low, rate.low_angle),
            at_angle(linkage, change.high, change.high_angle),
            at_angle(linkage, change.low, change.low_angle),
        };
    }
}

const Solver ANALYTIC_SOLVER = {
    .name = "analytic",
    .is_ideal = true,
    .open = analytic_open,
    .step = analytic_step,
    .record = analytic_record,
    .observe = analytic_observe,
    .model = analytic_model,
    .extremes = analytic_extremes,
    .close = analytic_close,
};

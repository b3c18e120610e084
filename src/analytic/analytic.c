// How does a four-bar with ideal joints move, sample by sample? (A solver.)
//
// Its steps are the sample intervals: nothing lives in between. Play is ignored, so that with play
// the difference of another solver to this one is the effect of the play plus that solver's error.
#include "analytic/analytic.h"

#include "analytic/fourbar_motion.h"
#include "analytic/inverse_dynamics.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BODIES = 3 };

typedef struct Analytic {
    const Scenario *scenario;
    FourBarLengths lengths;
    double start_s;
    double end_s;
    size_t steps;
    double omega[BODIES]; // at end_s
    double alpha[BODIES];
    JointState joints[LINKAGE_JOINT_MAX];
    double approach[LINKAGE_JOINT_MAX];
} Analytic;

// The state at any time, angles in the turn of the principal value.
static bool evaluate(const Analytic *analytic, double time_s, Sample *sample, Err *err)
{
    const Linkage *linkage = &analytic->scenario->linkage;
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    if (!fourbar_motion_bodies(&analytic->lengths, linkage->driver.speed, sample->crank_rad,
                               sample->bodies)) {
        return err_set(err, ERR_SOLVER,
                       "at %.6g ms, crank angle %.6g deg: the four-bar does not close",
                       1e3 * time_s, sample->crank_rad * 180.0 / M_PI);
    }
    Reactions reactions;
    if (!inverse_dynamics_solve(linkage, sample->bodies, analytic->scenario->gravity, &reactions,
                                err)) {
        return false;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        sample->joints[i] = (JointState){
            .force = vec2_length(reactions.force_on_b[i]),
            .is_touching = true,
        };
    }
    return true;
}

static void analytic_close(void *state)
{
    free(state);
}

static bool analytic_open(const Scenario *scenario, void **state, Err *err)
{
    if (!scenario->has_fourbar) {
        return err_set(err, ERR_SOLVER, "the analytic solver knows four-bars only");
    }
    Analytic *analytic = calloc(1, sizeof *analytic);
    assert(analytic != NULL);
    analytic->scenario = scenario;
    analytic->lengths = fourbar_motion_nominal(&scenario->fourbar);
    *state = analytic;
    return true;
}

static bool analytic_step(void *state, double stop_s, Err *err)
{
    Analytic *analytic = state;
    Sample sample;
    if (!evaluate(analytic, stop_s, &sample, err)) {
        return false;
    }
    for (size_t i = 0; i < BODIES; i++) {
        analytic->omega[i] = sample.bodies[i].omega;
        analytic->alpha[i] = sample.bodies[i].alpha;
    }
    memcpy(analytic->joints, sample.joints, sizeof analytic->joints);
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
        .joints = analytic->joints,
        .approach = analytic->approach,
    };
}

static void analytic_observe(const void *state, double time_s, Sample *sample)
{
    Err err = {ERR_NONE, ""};
    // the step before has evaluated the loop at the end of this interval
    const bool is_closed = evaluate(state, time_s, sample, &err);
    assert(is_closed);
    (void)is_closed;
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

static void analytic_extremes(const void *state, BodyExtremes *bodies)
{
    const Analytic *analytic = state;
    const Linkage *linkage = &analytic->scenario->linkage;
    const double first = linkage->driver.start;
    // the motion repeats every turn: its extremes stand in the first one
    const double run = linkage_crank_angle(linkage, analytic->end_s) - first;
    const double last = first + copysign(fmin(fabs(run), 2.0 * M_PI), run);
    for (size_t i = 1; i < BODIES; i++) {
        const FourBarQuantity omega = i == 1 ? FOURBAR_COUPLER_OMEGA : FOURBAR_FOLLOWER_OMEGA;
        const FourBarQuantity alpha = i == 1 ? FOURBAR_COUPLER_ALPHA : FOURBAR_FOLLOWER_ALPHA;
        const double speed = linkage->driver.speed;
        const FourBarExtreme rate =
            fourbar_motion_extreme(&analytic->lengths, speed, omega, first, last);
        const FourBarExtreme change =
            fourbar_motion_extreme(&analytic->lengths, speed, alpha, first, last);
        bodies[i] = (BodyExtremes){
            .omega_max = at_angle(linkage, rate.high, rate.high_angle),
            .omega_min = at_angle(linkage, rate.low, rate.low_angle),
            .alpha_max = at_angle(linkage, change.high, change.high_angle),
            .alpha_min = at_angle(linkage, change.low, change.low_angle),
        };
    }
}

const Solver ANALYTIC_SOLVER = {
    .name = "analytic",
    .summary = "closed-form four-bar with ideal joints",
    .open = analytic_open,
    .step = analytic_step,
    .record = analytic_record,
    .observe = analytic_observe,
    .model = analytic_model,
    .extremes = analytic_extremes,
    .close = analytic_close,
};

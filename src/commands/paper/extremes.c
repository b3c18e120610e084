// How far do coupler and follower swing in speed and acceleration, by the paper and by us?
//
// Ideal rows      the closed form, extremes at their exact crank angles
// Analytical row  the same curve sampled at whole degrees of crank angle, as the paper must have
// Stack-up rows   ODE on the case with play; peaks over every step. IMPACT with contacts that are
//                 integrated within the step: at 10 us its peaks are right to 5e-5, where textbook
//                 use of ODE is off by a tenth at 1 us. POISSON's forces are impulses over a step.
//                 It takes longest: a thread makes all else meanwhile.
//
// The crank turns clockwise, which flips the signs of omega and leaves those of alpha. The paper
// gives no step, damping, restitution, friction or sampling for its stack-up rows, and a peak of
// acceleration depends on all of them: those rows are orders of magnitude.
#include "commands/paper/paper.h"

#include "analytic/fourbar_motion.h"
#include "base/text.h"
#include "commands/paper/embedded.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { DEGREES = 360 };

static const double IMPACT_STEP_S = 1e-5;

static const RunWatch NOBODY = {NULL, NULL};

static const char *const BODY_NAMES[] = {"coupler", "follower"};

// The row's own numbers: what they are made of, and how far from the printed ones.
static void finish_row(ExtremesRow *row)
{
    row->is_known = true;
    for (int i = 0; i < PRINTED_QUANTITY_COUNT; i++) {
        const double difference = fabs(row->ours[i] - row->printed[i]) / fabs(row->printed[i]);
        row->difference_max = fmax(row->difference_max, difference);
        row->as_printed +=
            printed_agrees(row->ours[i], row->printed[i], printed_decimals(i)) ? 1 : 0;
    }
}

static void take_joint(const Scenario *scenario, const Trajectory *run, ExtremesRow *row)
{
    for (size_t i = 0; i < run->joint_count; i++) {
        if (scenario->linkage.joints[i].kind == JOINT_CLEARANCE) {
            row->impacts += run->joints[i].impacts;
            row->force_max = fmax(row->force_max, run->joints[i].force_max.value);
        }
    }
}

static void take_bodies(const Scenario *scenario, const Trajectory *run, ExtremesRow *row)
{
    for (int i = 0; i < 2; i++) {
        const int body = linkage_find_body(&scenario->linkage, BODY_NAMES[i]);
        if (body < 0) {
            snprintf(row->message, sizeof row->message, "the case has no body %s", BODY_NAMES[i]);
            return;
        }
        const BodyExtremes *extremes = &run->bodies[body];
        row->ours[2 * i] = extremes->omega_max.value;
        row->ours[2 * i + 1] = extremes->omega_min.value;
        row->ours[2 * i + 4] = extremes->alpha_max.value;
        row->ours[2 * i + 5] = extremes->alpha_min.value;
    }
    finish_row(row);
}

// Takes a run, which it destroys, into a row.
static void fill_by_run(const Scenario *scenario, Trajectory *run, ExtremesRow *row)
{
    text_copy(row->label, sizeof row->label, run->label);
    row->step_s = run->step_s;
    if (run->is_complete) {
        take_joint(scenario, run, row);
        take_bodies(scenario, run, row);
    } else {
        text_copy(row->message, sizeof row->message, run->message);
    }
    trajectory_destroy(run);
}

static bool fill_ideal(EmbeddedCase which, ExtremesRow *row, Err *err)
{
    Scenario scenario;
    if (!embedded_load(which, &scenario, err)) {
        return false;
    }
    fill_by_run(&scenario, run_scenario(&scenario, registry_solver(BACKEND_ANALYTIC), NOBODY), row);
    scenario_free(&scenario);
    return true;
}

static bool fill_impact(ExtremesRow *row, Err *err)
{
    Scenario scenario;
    if (!embedded_load(EMBEDDED_STACKUP_IMPACT, &scenario, err)) {
        return false;
    }
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.run.step = IMPACT_STEP_S;
    scenario.run.keeps_ranges = false;
    // peaks inside the steps count
    fill_by_run(&scenario, tracer_run(&scenario, registry_solver(BACKEND_ODE), NOBODY), row);
    scenario_free(&scenario);
    return true;
}

static bool fill_poisson(RunWatch watch, ExtremesRow *row, Err *err)
{
    Scenario scenario;
    if (!embedded_load(EMBEDDED_STACKUP_POISSON, &scenario, err)) {
        return false;
    }
    // nothing else of it is read
    scenario.run.is_lean = true;
    scenario.run.samples = 1;
    fill_by_run(&scenario, run_scenario(&scenario, registry_solver(BACKEND_ODE), watch), row);
    scenario_free(&scenario);
    return true;
}

// Largest and smallest of a curve sampled at whole degrees.
static void sampled_range(const double *values, double *high, double *low)
{
    *high = values[0];
    *low = values[0];
    for (int i = 1; i < DEGREES; i++) {
        *high = fmax(*high, values[i]);
        *low = fmin(*low, values[i]);
    }
}

static bool fill_by_sampling(ExtremesRow *row, Err *err)
{
    Scenario scenario;
    if (!embedded_load(EMBEDDED_IDEAL_NOMINAL, &scenario, err)) {
        return false;
    }
    double angles[DEGREES];
    double curves[4][DEGREES]; // coupler omega, follower omega, coupler alpha, follower alpha
    for (int i = 0; i < DEGREES; i++) {
        angles[i] = 2.0 * M_PI * i / DEGREES;
    }
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    const FourBarGrid grid = {
        .coupler_omega = curves[0],
        .follower_omega = curves[1],
        .coupler_alpha = curves[2],
        .follower_alpha = curves[3],
    };
    fourbar_motion_grid(&lengths, scenario.linkage.driver.speed, DEGREES, angles, &grid);
    scenario_free(&scenario);
    for (int i = 0; i < 4; i++) {
        sampled_range(curves[i], &row->ours[2 * i], &row->ours[2 * i + 1]);
    }
    text_copy(row->label, sizeof row->label, "analytic, sampled at whole degrees");
    finish_row(row);
    return true;
}

// A row with nothing of ours yet.
static ExtremesRow empty_row(int number)
{
    ExtremesRow row = {
        .name = PRINTED_EXTREMES[number].name,
        .is_target = number != PRINTED_POISSON && number != PRINTED_IMPACT,
    };
    for (int j = 0; j < PRINTED_QUANTITY_COUNT; j++) {
        row.printed[j] = PRINTED_EXTREMES[number].values[j];
    }
    return row;
}

bool extremes_longest(RunWatch watch, ExtremesRow *row, Err *err)
{
    *row = empty_row(PRINTED_POISSON);
    return fill_poisson(watch, row, err);
}

bool extremes_others(ExtremesRow rows[PRINTED_ROW_COUNT], Err *err)
{
    for (int i = 0; i < PRINTED_ROW_COUNT; i++) {
        if (i != PRINTED_POISSON) {
            rows[i] = empty_row(i);
        }
    }
    return fill_ideal(EMBEDDED_IDEAL_NOMINAL, &rows[PRINTED_IDEAL_NOMINAL], err) &&
           fill_ideal(EMBEDDED_IDEAL_STACKUP, &rows[PRINTED_IDEAL_STACKUP], err) &&
           fill_impact(&rows[PRINTED_IMPACT], err) &&
           fill_by_sampling(&rows[PRINTED_IDEAL_ANALYTICAL], err);
}

double extremes_difference_max(const ExtremesRow rows[PRINTED_ROW_COUNT])
{
    double difference = 0.0;
    for (int i = 0; i < PRINTED_ROW_COUNT; i++) {
        if (rows[i].is_target) {
            difference = rows[i].is_known ? fmax(difference, rows[i].difference_max) : INFINITY;
        }
    }
    return difference;
}

int extremes_as_printed(const ExtremesRow rows[PRINTED_ROW_COUNT], int *cell_count)
{
    int count = 0;
    *cell_count = 0;
    for (int i = 0; i < PRINTED_ROW_COUNT; i++) {
        if (rows[i].is_target) {
            count += rows[i].as_printed;
            *cell_count += PRINTED_QUANTITY_COUNT;
        }
    }
    return count;
}

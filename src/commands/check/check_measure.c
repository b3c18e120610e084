// How is a scenario measured?
//
// On each of its backends, as check_add.c lists. A motion that cannot be predicted to its end is
// measured twice, to its end and up to the horizon; errors are then measured up to the horizon.
#include "commands/check/check_measure.h"

#include "base/printable.h"
#include "base/room.h"
#include "base/text.h"
#include "base/zeroed.h"
#include "commands/check/expect_value.h"
#include "measure/backend_run.h"
#include "model/perturb.h"
#include "model/shake.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <math.h>
#include <stdio.h>

enum { HALVINGS = 2 }; // of the step, for the order

static const ChosenWatch NOBODY = {.begin = NULL};

static void note_failure(CheckMeasure *measure, const Trajectory *run)
{
    measure->is_complete = false;
    Text words;
    text_init(&words);
    text_append(&words, "%s failed: %s", run->backend, run->message);
    shorten_copy(measure->message, sizeof measure->message, words.data);
    text_finish(&words);
}

// A run that is complete, or NULL with the reason in the measure.
static Trajectory *run_backend(CheckAdd *work, const Scenario *scenario, BackendKind backend,
                               const Truth *truth)
{
    Trajectory *run = backend_run(scenario, backend, truth, NOBODY, &TRACER_PROBE);
    if (!run->is_complete) {
        note_failure(work->measure, run);
        trajectory_destroy(run);
        return NULL;
    }
    return run;
}

static double find_error(CheckAdd *work, const Scenario *scenario, const Trajectory *truth)
{
    Trajectory *run = run_backend(work, scenario, BACKEND_ODE, NULL);
    const double error = run != NULL ? error_against(run, truth, INFINITY).max : NAN;
    trajectory_destroy(run);
    return error;
}

// The order from each step to its half, where the truth is sure enough to tell.
static void add_orders(CheckAdd *work, const Trajectory *run, const Trajectory *truth,
                       const CheckPlan *plan)
{
    static const char *const NAMES[HALVINGS] = {"order_1", "order_at_half_step_1"};
    Scenario scenario = *work->scenario;
    double error = error_against(run, truth, INFINITY).max;
    for (int i = 0; i < HALVINGS && work->measure->is_complete; i++) {
        scenario.run.step *= 0.5;
        const double finer = find_error(work, &scenario, truth);
        if (!(finer > ERROR_CLEAR_OF_TRUTH * plan->uncertainty)) {
            return;
        }
        check_add_order(work, run, NAMES[i], error, finer);
        error = finer;
    }
}

// What the run says of the limits of its case: of errors where there is one, of all else where it
// is the whole run.
static void measure_expected(CheckAdd *work, BackendKind backend, const Trajectory *run,
                             const TrajectoryError *error)
{
    const bool is_whole = work->group[0] == '\0';
    for (size_t i = 0; i < work->scenario->expectation_count; i++) {
        const Expectation *expectation = &work->scenario->expectations[i];
        if (expect_value_is_error(expectation) ? error != NULL : is_whole && error == NULL) {
            work->measure->expected[i][backend] = expect_value_of(expectation, run, error);
        }
    }
}

static void measure_run(CheckAdd *work, BackendKind backend, Trajectory *run,
                        const Trajectory *truth, const CheckPlan *plan)
{
    check_add_run(work, run, backend);
    measure_expected(work, backend, run, NULL);
    if (truth == NULL || run == truth) {
        return;
    }
    TrajectoryError error = error_against(run, truth, INFINITY);
    if (!error.is_known) {
        return;
    }
    if (error_fail_unstable(run, truth, &error)) {
        note_failure(work->measure, run);
        return;
    }
    check_add_error(work, run, &error, plan->uncertainty);
    measure_expected(work, backend, run, &error);
    if (plan->is_full && backend == BACKEND_ODE && work->scenario->run.step > 0.0) {
        add_orders(work, run, truth, plan);
    }
}

// What a step is chosen against: as sure, and as far, as was settled with the baseline.
static Truth settled_truth(Trajectory *truth, const CheckPlan *plan)
{
    return (Truth){
        .trajectory = truth,
        .uncertainty = plan->uncertainty,
        .horizon_s = plan->horizon_s,
        .is_limited = plan->is_limited,
    };
}

static void measure_group(const Scenario *scenario, const char *group, bool has_truth,
                          const CheckPlan *plan, CheckMeasure *measure)
{
    CheckAdd work = check_add_begin(scenario, group, measure);
    const BackendKind judge = truth_backend(scenario);
    Trajectory *truth = has_truth ? run_backend(&work, scenario, judge, NULL) : NULL;
    const Truth known = settled_truth(truth, plan);
    for (size_t i = 0; measure->is_complete && i < scenario->run.backend_count; i++) {
        const BackendKind backend = scenario->run.backends[i];
        const bool is_there = truth != NULL && backend == judge;
        Trajectory *run =
            is_there ? truth : run_backend(&work, scenario, backend, truth == NULL ? NULL : &known);
        if (run != NULL) {
            measure_run(&work, backend, run, truth, plan);
        }
        if (!is_there) {
            trajectory_destroy(run);
        }
    }
    trajectory_destroy(truth);
    check_add_end(&work);
}

// The scenario up to the horizon, on the backends that feel it.
static Scenario cut_short(const Scenario *scenario, double horizon_s)
{
    Scenario cut = *scenario;
    const double share = horizon_s / scenario_duration(scenario);
    cut.run.revolutions *= share;
    cut.run.duration *= share;
    if (!drive_is_steady(&cut.linkage.driver)) {
        // samples are those of the whole run there
        cut.run.samples = (size_t)round(share * (double)cut.run.samples);
    }
    cut.run.backend_count = 0;
    for (size_t i = 0; i < scenario->run.backend_count; i++) {
        if (OPTIONS_BACKEND_HAS_PLAY[scenario->run.backends[i]]) {
            cut.run.backends[cut.run.backend_count++] = scenario->run.backends[i];
        }
    }
    return cut;
}

CheckPlan check_plan(const Truth *truth)
{
    const bool is_certified = truth->message[0] == '\0' && isfinite(truth->uncertainty);
    return (CheckPlan){
        .has_truth = is_certified && truth->trajectory->is_complete,
        .uncertainty = is_certified ? truth->uncertainty : 0.0,
        .is_limited = is_certified && truth->is_limited,
        .horizon_s = is_certified && truth->is_limited ? truth->horizon_s : 0.0,
        .is_full = true,
    };
}

// What feels the play of a scenario and is measured: perturbations are relative to its motion.
static BackendKind motion_backend(const Scenario *scenario)
{
    for (size_t i = 0; i < scenario->run.backend_count; i++) {
        if (OPTIONS_BACKEND_HAS_PLAY[scenario->run.backends[i]]) {
            return scenario->run.backends[i];
        }
    }
    return BACKEND_REFERENCE;
}

void check_measure_start(Scenario *scenario, CheckStart start)
{
    if (start.shake > 0) {
        shake_inputs(scenario, start.shake);
    }
    if (start.member > 0) {
        PerturbUnit *units = zeroed(scenario->linkage.body_count, sizeof *units);
        Trajectory *own = backend_run(scenario, motion_backend(scenario), NULL, NOBODY, NULL);
        // a run that fails here will fail when it is measured
        if (own->is_complete) {
            perturb_units(own, units);
            perturb_start(scenario, units, start.share, start.member);
        }
        trajectory_destroy(own);
        free(units);
    }
}

void check_measure(const Scenario *scenario, const CheckPlan *plan, CheckMeasure *measure)
{
    measure->count = 0;
    measure->is_complete = true;
    measure->message[0] = '\0';
    for (size_t i = 0; i < EXPECTATION_MAX * BACKEND_COUNT; i++) {
        measure->expected[i / BACKEND_COUNT][i % BACKEND_COUNT] = NAN;
    }
    measure_group(scenario, "", plan->has_truth && !plan->is_limited, plan, measure);
    if (measure->is_complete && plan->is_limited && plan->horizon_s > 0.0) {
        const Scenario cut = cut_short(scenario, plan->horizon_s);
        // a horizon without a sample beyond the start measures nothing
        if (scenario_sample_count(&cut) > 1) {
            measure_group(&cut, "-to-horizon", plan->has_truth, plan, measure);
        }
    }
    if (!measure->is_complete) {
        measure->count = 0;
    }
}

void check_measure_finish(CheckMeasure *measure)
{
    free(measure->metrics);
    *measure = (CheckMeasure){.is_complete = false};
}

CheckMeasure check_measure_copy(const CheckMeasure *measure)
{
    CheckMeasure copy = *measure;
    copy.room = copy.count;
    copy.metrics = room_copy(measure->metrics, copy.count, sizeof *copy.metrics);
    return copy;
}

size_t check_measure_packed_size(const Scenario *scenario)
{
    // as check_add.c has them: extremes and spikes; forces, contacts and spikes; energy, cost,
    // errors and orders
    enum { OF_BODY = 6, OF_JOINT = 7, OF_RUN = 16, GROUPS = 2 };
    const Linkage *linkage = &scenario->linkage;
    const size_t count = OF_BODY * linkage->body_count + OF_JOINT * linkage->joint_count + OF_RUN;
    return sizeof(CheckMeasure) +
           GROUPS * scenario->run.backend_count * count * sizeof(CheckMetric);
}

void check_measure_pack(const CheckMeasure *measure, void *packed, size_t size)
{
    CheckMeasure *head = packed;
    assert(sizeof *head + measure->count * sizeof *measure->metrics <= size);
    *head = *measure;
    if (measure->count > 0) {
        memcpy(head + 1, measure->metrics, measure->count * sizeof *measure->metrics);
    }
}

CheckMeasure check_measure_unpack(const void *packed)
{
    CheckMeasure head = *(const CheckMeasure *)packed;
    head.metrics = (CheckMetric *)((const CheckMeasure *)packed + 1);
    return check_measure_copy(&head);
}

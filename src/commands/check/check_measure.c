// Measures a scenario: the numbers of its runs that a check compares.
//
// On each of its backends, as listed below. A motion that cannot be predicted to its end is
// measured twice, to its end and up to the horizon; errors are then measured up to the horizon.
#include "commands/check/check_measure.h"
#include "base/printable.h"
#include "base/room.h"
#include "base/text.h"
#include "base/zeroed.h"
#include "contact/law.h"
#include "measure/chosen_run.h"
#include "measure/number_values.h"
#include "measure/truth.h"
#include "model/perturb.h"
#include "model/shake.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

// The number of a run that a limit of its case means.

bool expect_value_is_error(const Expectation *expectation)
{
    const NumberOwner owner = NUMBERS[expectation->number].owner;
    return owner == NUMBER_OWNER_ERROR || owner == NUMBER_OWNER_TRUTH;
}

bool expect_value_is_settled(const Expectation *expectation)
{
    const NumberOwner owner = NUMBERS[expectation->number].owner;
    return owner == NUMBER_OWNER_SETTLED || owner == NUMBER_OWNER_SETTLED_JOINT ||
           owner == NUMBER_OWNER_SETTLED_BODY;
}

double expect_value_of_settled(const Expectation *expectation, const Scenario *scenario)
{
    const NumberSource source = {.scenario = scenario};
    return number_find(expectation->number, &source, (size_t)expectation->member).value;
}

bool expect_value_concerns(const Expectation *expectation, const Scenario *scenario,
                           BackendKind backend)
{
    if (expectation->backend != EXPECTATION_ANY_BACKEND) {
        return expectation->backend == (int)backend;
    }
    if (expect_value_is_error(expectation) && backend == truth_backend(scenario)) {
        return false;
    }
    return OPTIONS_BACKEND_HAS_PLAY[backend] || !scenario_has_clearance(scenario);
}

double expect_value_off(const Expectation *expectation, double value)
{
    const double low = expectation->low;
    const double high = expectation->high;
    const bool is_low = expectation->is_open ? !(value > low) : !(value >= low);
    const bool is_high = expectation->is_open ? !(value < high) : !(value <= high);
    return is_high ? fmax(value - high, DBL_MIN) : is_low ? fmin(value - low, -DBL_MIN) : 0.0;
}

// The numbers of one run.
//
// Those of model/number_list.h that have NUMBER_CHECK; the order of convergence
// p = log2(e(h) / e(h/2)); the hash.
//
// Rounding: a number of a run is known to some 1e-12 of its scale, and an acceleration, as the
// difference of two speeds over a step, to no better than 16 eps omega / h.

static const double ROUNDING = 1e-12;    // of a scale: some 5000 roundings, all to one side
static const double CHOSEN_STEPS = 0.05; // of their number: a change of the method costs more
static const double SPEED_ULPS = 16; // of a speed before and after a step, and of what made them

static void check_measure_add(CheckAdd *work, const Trajectory *run, const char *part,
                              const char *name, CheckMetric metric)
{
    CheckMeasure *measure = work->measure;
    snprintf(metric.name, sizeof metric.name, "%s%s/%s%s%s", run->backend, work->group, part,
             part[0] != '\0' ? "/" : "", name);
    if (isnan(metric.value) && run->engine.name[0] != '\0') {
        return; // another engine does not tell it
    }
    if (!isfinite(metric.value)) {
        measure->is_complete = false;
        snprintf(measure->message, sizeof measure->message, "%s is not finite", metric.name);
        return;
    }
    measure->metrics =
        room_grow(measure->metrics, &measure->room, measure->count + 1, sizeof metric);
    measure->metrics[measure->count++] = metric;
}

// A number of which rounding is that of something else, if that is larger than its scale.
static void check_measure_add_beside(CheckAdd *work, const Trajectory *run, const char *part,
                                     const char *name, double value, double scale, double beside)
{
    const double whole = fmax(fabs(value), scale);
    check_measure_add(work, run, part, name,
                      (CheckMetric){.kind = CHECK_REAL,
                                    .value = value,
                                    .scale = whole,
                                    .floor = ROUNDING * fmax(whole, beside)});
}

static void add_real(CheckAdd *work, const Trajectory *run, const char *part, const char *name,
                     double value, double scale)
{
    check_measure_add_beside(work, run, part, name, value, scale, 0.0);
}

// What a joint carries may be nothing but the rounding of what moves the mechanism.
static void check_measure_add_force(CheckAdd *work, const Trajectory *run, const Joint *joint,
                                    const char *name, double value, double scale)
{
    const double moving = linkage_is_torsional(joint) ? work->energy : work->force;
    check_measure_add_beside(work, run, joint->name, name, value, scale, moving);
}

static void add_count(CheckAdd *work, const Trajectory *run, const char *part, const char *name,
                      size_t value)
{
    check_measure_add(
        work, run, part, name,
        (CheckMetric){.kind = CHECK_COUNT, .value = (double)value, .scale = (double)value});
}

// What rounding of speeds makes of an acceleration, rad/s^2.
static double alpha_rounding(const Trajectory *run, double omega)
{
    return run->step_s > 0.0 ? SPEED_ULPS * DBL_EPSILON * omega / run->step_s : 0.0;
}

static void add_alpha(CheckAdd *work, const Trajectory *run, size_t number, const char *name,
                      double value, bool is_at_samples)
{
    const BodyExtremes found =
        is_at_samples ? number_extremes_at_samples(run, number) : run->bodies[number];
    const BodyExtremes *extremes = &found;
    const double omega = fmax(work->speeds.turning[number], fmax(fabs(extremes->omega_max.value),
                                                                 fabs(extremes->omega_min.value)));
    const double scale = fmax(work->speeds.speeding[number],
                              fmax(extremes->alpha_max.value, -extremes->alpha_min.value));
    const char *body = work->scenario->linkage.bodies[number].name;
    check_measure_add(work, run, body, name,
                      (CheckMetric){.kind = CHECK_REAL,
                                    .value = value,
                                    .scale = scale,
                                    .floor = ROUNDING * scale + alpha_rounding(run, omega)});
}

// Of steps that a solver chooses by itself extremes depend on where the steps fall: now and then by
// a thousandth, and mostly by nothing. Its samples, at fixed times, are as sure as the solver is.
static bool is_by_samples(BackendKind backend)
{
    return backend == BACKEND_REFERENCE;
}

// Steps that a solver chooses by itself differ by a percent or so after a rounding.
static void add_effort(CheckAdd *work, const Trajectory *run, const char *name, size_t value)
{
    const double floor = run->step_s > 0.0 ? 0.0 : CHOSEN_STEPS * (double)value;
    check_measure_add(
        work, run, "cost", name,
        (CheckMetric){
            .kind = CHECK_EFFORT, .value = (double)value, .scale = (double)value, .floor = floor});
}

// What a number is measured in, where that is more than the number itself.
static double scale_of(const CheckAdd *work, const Trajectory *run, NumberId id, size_t member)
{
    if (id == NUMBER_BODY_ALPHA_SPIKES_MEAN) {
        return run->alpha_spikes[member].threshold;
    }
    if (id == NUMBER_JOINT_FORCE_SPIKES_MEAN) {
        return run->force_spikes[member].threshold;
    }
    switch (NUMBERS[id].kind) {
    case NUMBER_OF_SPEED:
        return work->speeds.moving;
    case NUMBER_OF_ANGULAR_SPEED:
        return number_members(&NUMBERS[id]) == NUMBER_OF_BODIES ? work->speeds.turning[member]
                                                                : 0.0;
    case NUMBER_OF_ENERGY:
        return fmax(fabs(run->energy.drive_work), work->energy);
    case NUMBER_OF_COUNT:
    case NUMBER_OF_EFFORT:
    case NUMBER_OF_SHARE:
    case NUMBER_OF_RATIO:
    case NUMBER_OF_FORCE:
    case NUMBER_OF_IMPULSE:
    case NUMBER_OF_DEPTH:
    case NUMBER_OF_APPROACH:
    case NUMBER_OF_SIGNAL:
    case NUMBER_OF_SIGNAL_IMPULSE:
    case NUMBER_OF_LENGTH:
    case NUMBER_OF_ANGLE:
    case NUMBER_OF_ANGULAR_ACCELERATION:
    case NUMBER_OF_TIME:
    case NUMBER_OF_SPAN:
    case NUMBER_OF_MICROSECONDS:
    case NUMBER_OF_PRESSURE:
    case NUMBER_OF_PRESSURE_SPEED:
    case NUMBER_KIND_COUNT:
        break;
    }
    return 0.0;
}

// Whether a check of a run has a number of a member that it is of.
static bool is_checked(const CheckAdd *work, const Number *number, BackendKind backend)
{
    const bool is_felt = !number_needs_play(number) || OPTIONS_BACKEND_HAS_PLAY[backend];
    const bool is_rubbed =
        (number->traits & NUMBER_RUBBED) == 0 || law_has_friction(work->scenario);
    return (number->places & NUMBER_CHECK) != 0 && is_felt && is_rubbed;
}

// One number of a member, by what the source says.
static void add_number(CheckAdd *work, const NumberSource *source, NumberId id, size_t member)
{
    const Trajectory *run = source->run;
    const Linkage *linkage = &work->scenario->linkage;
    const Number *number = &NUMBERS[id];
    const NumberOwnerRow *owner = &NUMBER_OWNERS[number->owner];
    const bool is_of_joint = owner->members == NUMBER_OF_JOINTS;
    const bool is_at_samples = source->is_at_samples && (number->traits & NUMBER_STEPS) != 0 &&
                               !(is_of_joint && linkage_has_play(&linkage->joints[member]));
    const double value = number_find(id, source, member).value;
    if (isnan(value) && (number->traits & NUMBER_LACKED) != 0) {
        return;
    }
    const char *part =
        owner->part[0] != '\0' ? owner->part : number_member(number->owner, linkage, member);
    char name[CHECK_NAME_SIZE];
    snprintf(name, sizeof name, "%s%s%s%s%s", owner->before, number->name,
             is_at_samples ? "_at_samples" : "",
             number->unit_keys[number_turn(number->owner, linkage, member)], number->check_end);
    const double scale = scale_of(work, run, id, member);
    if (number->kind == NUMBER_OF_COUNT && isfinite(value)) {
        add_count(work, run, part, name, (size_t)value);
    } else if (number->kind == NUMBER_OF_EFFORT && isfinite(value)) {
        add_effort(work, run, name, (size_t)value);
    } else if (number->kind == NUMBER_OF_FORCE && is_of_joint) {
        check_measure_add_force(work, run, &linkage->joints[member], name, value, scale);
    } else if ((number->traits & NUMBER_OF_ALPHA) != 0 && owner->members == NUMBER_OF_BODIES) {
        add_alpha(work, run, member, name, value, source->is_at_samples);
    } else {
        add_real(work, run, part, name, value, scale);
    }
}

// All numbers of a run but errors.
static void add_numbers(CheckAdd *work, const Trajectory *run, BackendKind backend)
{
    const Linkage *linkage = &work->scenario->linkage;
    const NumberSource source = {
        .scenario = work->scenario, .run = run, .is_at_samples = is_by_samples(backend)};
    for (NumberOwner owner = 0; owner < NUMBER_OWNER_COUNT; owner++) {
        for (size_t i = 0; i < number_member_count(owner, linkage); i++) {
            for (NumberId id = 0; id < NUMBER_COUNT; id++) {
                if (NUMBERS[id].owner == owner && owner != NUMBER_OWNER_ERROR &&
                    is_checked(work, &NUMBERS[id], backend) &&
                    number_is_of(&NUMBERS[id], linkage, i)) {
                    add_number(work, &source, id, i);
                }
            }
        }
    }
    check_measure_add(work, run, "", "hash", (CheckMetric){.kind = CHECK_HASH, .hash = run->hash});
}

// Whether an error is one that a tolerance of the case may be of: that of the motion always, of
// forces or peaks where it is of those.
static bool is_of_tolerance(const Number *number, ToleranceOf kind)
{
    const bool is_of_forces = (number->traits & NUMBER_OF_FORCES) != 0;
    const bool is_of_peaks = (number->traits & NUMBER_OF_PEAKS) != 0;
    return (!is_of_forces && !is_of_peaks) ||
           (kind != TOLERANCE_OF_MOTION && (kind == TOLERANCE_OF_FORCES) == is_of_forces);
}

// Errors are shares already: what rounding may change of them is a share of 1, and the truth that
// they are against may itself be off by its uncertainty. Without play there are none of forces.
static void check_add_error(CheckAdd *work, const Trajectory *run, const TrajectoryError *error,
                            double uncertainty)
{
    const NumberSource source = {.scenario = work->scenario, .run = run, .error = error};
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const Number *number = &NUMBERS[id];
        const double value = number_find(id, &source, 0).value;
        if (number->owner != NUMBER_OWNER_ERROR || (number->places & NUMBER_CHECK) == 0 ||
            !is_of_tolerance(number, work->scenario->run.tolerance_of) ||
            ((number->traits & NUMBER_LACKED) != 0 && isnan(value))) {
            continue;
        }
        char name[CHECK_NAME_SIZE];
        snprintf(name, sizeof name, "%s%s", number->keys[NUMBER_PUSHED], number->check_end);
        const bool is_of_alpha = (number->traits & NUMBER_OF_ALPHA) != 0;
        check_measure_add(work, run, NUMBER_OWNERS[number->owner].part, name,
                          (CheckMetric){.kind = CHECK_REAL,
                                        .value = value,
                                        .scale = value,
                                        .floor = ROUNDING + uncertainty +
                                                 (is_of_alpha ? alpha_rounding(run, 1.0) : 0.0)});
    }
}

// Adds what the error is, against a truth that is known to `uncertainty`, and one order of
// convergence from two errors.
static void check_add_order(CheckAdd *work, const Trajectory *run, const char *name, double error,
                            double finer)
{
    // the quotient of two errors, each known to ROUNDING
    const double floor = 2.0 * ROUNDING / (finer * M_LN2);
    check_measure_add(work, run, "error", name,
                      (CheckMetric){.kind = CHECK_REAL,
                                    .is_slow = true,
                                    .value = log2(error / finer),
                                    .scale = 1.0,
                                    .floor = floor});
}

static CheckAdd check_add_begin(const Scenario *scenario, const char *group, CheckMeasure *measure)
{
    CheckAdd work = {
        .scenario = scenario, .measure = measure, .group = group, .speeds = scale_speeds(scenario)};
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        const Body *body = &scenario->linkage.bodies[i];
        work.energy += 0.5 * body->mass * work.speeds.moving * work.speeds.moving;
        work.force += body->mass * work.speeds.changing;
    }
    return work;
}

// For check_add_end.
static void check_add_end(CheckAdd *work)
{
    scale_free(&work->speeds);
}

enum { HALVINGS = 2 }; // of the step, for the order

static const ChosenWatch NOBODY = {.begin = NULL};

static void check_measure_note_failure(CheckMeasure *measure, const Trajectory *run)
{
    measure->is_complete = false;
    Text words;
    text_init(&words);
    text_append(&words, "%s failed: %s", run->backend, run->message);
    shorten_copy(measure->message, sizeof measure->message, words.data);
    text_finish(&words);
}

// A run that is complete, or NULL with the reason in the measure.
static Trajectory *check_measure_run_backend(CheckAdd *work, const Scenario *scenario,
                                             BackendKind backend, const Truth *truth)
{
    Trajectory *run = backend_run(scenario, backend, truth, NOBODY, &TRACER_PROBE);
    if (!run->is_complete) {
        check_measure_note_failure(work->measure, run);
        trajectory_destroy(run);
        return NULL;
    }
    return run;
}

static double find_error(CheckAdd *work, const Scenario *scenario, const Trajectory *truth)
{
    Trajectory *run = check_measure_run_backend(work, scenario, BACKEND_ODE, NULL);
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
            const NumberSource source = {.scenario = work->scenario, .run = run, .error = error};
            work->measure->expected[i][backend] =
                number_find(expectation->number, &source, (size_t)expectation->member).value;
        }
    }
}

static void measure_run(CheckAdd *work, BackendKind backend, Trajectory *run,
                        const Trajectory *truth, const CheckPlan *plan)
{
    add_numbers(work, run, backend);
    measure_expected(work, backend, run, NULL);
    if (truth == NULL || run == truth) {
        return;
    }
    TrajectoryError error = error_against(run, truth, INFINITY);
    if (!error.is_known) {
        return;
    }
    if (error_fail_unstable(run, truth, &error)) {
        check_measure_note_failure(work->measure, run);
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
    Trajectory *truth = has_truth ? check_measure_run_backend(&work, scenario, judge, NULL) : NULL;
    const Truth known = settled_truth(truth, plan);
    for (size_t i = 0; measure->is_complete && i < scenario->run.backend_count; i++) {
        const BackendKind backend = scenario->run.backends[i];
        const bool is_there = truth != NULL && backend == judge;
        Trajectory *run = is_there ? truth
                                   : check_measure_run_backend(&work, scenario, backend,
                                                               truth == NULL ? NULL : &known);
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
    if (start.share > 0.0) {
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
    enum { GROUPS = 2 };
    size_t count = HALVINGS + 1; // the orders and the hash
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const bool is_there = (NUMBERS[id].places & NUMBER_CHECK) != 0;
        count += is_there ? number_member_count(NUMBERS[id].owner, &scenario->linkage) : 0;
    }
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

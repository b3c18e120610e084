// Measures a scenario: the numbers of its runs that a check compares.
//
// On each of its backends, as listed below. A motion that cannot be predicted to its end is
// measured twice, to its end and up to the horizon; errors are then measured up to the horizon.
#include "commands/check/check_measure.h"
#include "base/printable.h"
#include "base/room.h"
#include "base/text.h"
#include "base/zeroed.h"
#include "casefile/expect.h"
#include "contact/law.h"
#include "measure/chosen_run.h"
#include "measure/section.h"
#include "measure/spectrum.h"
#include "measure/truth.h"
#include "model/joint_numbers.h"
#include "model/perturb.h"
#include "model/shake.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

// The number of a run that a limit of its case means.

static double spikes(const SignalSpikes *found)
{
    return found->is_known ? (double)found->count : NAN;
}

static double error_number(const TrajectoryError *error, ExpectedNumber number)
{
    if (error == NULL || !error->is_known) {
        return NAN;
    }
    switch (number) {
    case EXPECTED_ERROR_MAX:
        return error->max;
    case EXPECTED_ERROR_OMEGA_MAX:
        return error->omega_max;
    case EXPECTED_ERROR_OMEGA_RMS:
        return error->omega_rms;
    case EXPECTED_ERROR_ALPHA_MAX:
        return error->alpha_max;
    case EXPECTED_ERROR_FORCE_MAX:
        return error->force_max;
    case EXPECTED_ERROR_PEAK_FORCE_MAX:
        return error->peak_force_max;
    case EXPECTED_ERROR_PEAK_ALPHA_MAX:
        return error->peak_alpha_max;
    default:
        return NAN;
    }
}

bool expect_value_is_error(const Expectation *expectation)
{
    return EXPECT_ROWS[expectation->number].group == EXPECT_ERROR;
}

bool expect_value_is_settled(const Expectation *expectation)
{
    const ExpectGroup group = EXPECT_ROWS[expectation->number].group;
    return group == EXPECT_SETTLED || group == EXPECT_SETTLED_JOINTS;
}

double expect_value_of_settled(const Expectation *expectation, const Scenario *scenario)
{
    const SettledStart *settled = &scenario->settled;
    if (settled->motion_count == 0) {
        return NAN;
    }
    const SettledMotion *motion = &settled->motions[0];
    const SettledNumber *force = &motion->joints[expectation->member].force;
    switch (expectation->number) {
    case EXPECTED_SETTLED_PERIOD:
        return (double)motion->period;
    case EXPECTED_SETTLED_SHARE:
        return (double)motion->starts / (double)settled->starts;
    case EXPECTED_SETTLED_FORCE_MAX:
        return force->headline;
    case EXPECTED_SETTLED_FORCE_MEDIAN:
        return force->median;
    case EXPECTED_SETTLED_FORCE_LARGEST:
        return force->largest;
    case EXPECTED_SETTLED_MOTIONS:
        return (double)settled->motion_count;
    default:
        return settled->has_growth ? settled->growth.factor : NAN;
    }
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

// The number of a complete run, SI; of an error from the error given, which is NULL where there is
// none. NAN where the run does not have it.
static double expect_value_of(const Expectation *expectation, const Trajectory *run,
                              const TrajectoryError *error)
{
    const BodyExtremes *body = &run->bodies[expectation->member];
    switch (expectation->number) {
    case EXPECTED_OMEGA_MAX:
        return body->omega_max.value;
    case EXPECTED_OMEGA_MIN:
        return body->omega_min.value;
    case EXPECTED_ALPHA_MAX:
        return body->alpha_max.value;
    case EXPECTED_ALPHA_MIN:
        return body->alpha_min.value;
    case EXPECTED_ALPHA_SPIKES:
        return spikes(&run->alpha_spikes[expectation->member]);
    case EXPECTED_OMEGA_ORDER_1:
        return spectrum_body_order(run, (size_t)expectation->member, 1);
    case EXPECTED_OMEGA_ORDER_2:
        return spectrum_body_order(run, (size_t)expectation->member, 2);
    case EXPECTED_OMEGA_BETWEEN_ORDERS:
        return spectrum_body_between(run, (size_t)expectation->member);
    case EXPECTED_OMEGA_SECTION:
        return section_omega(run, (size_t)expectation->member, 0);
    case EXPECTED_SECTION_PERIOD:
        return section_period(run);
    case EXPECTED_SECTION_CHANGE:
        return section_find(run).change;
    case EXPECTED_FORCE_SPIKES:
        return spikes(&run->force_spikes[expectation->member]);
#define EXPECTED_OF_JOINT(id, ...)                                                                 \
    case EXPECTED_##id:                                                                            \
        return joint_numbers_find(JOINT_NUMBER_##id, run, (size_t)expectation->member).value;
        JOINT_NUMBERS_OF_ANY_LIST(EXPECTED_OF_JOINT)
        JOINT_NUMBERS_OF_PLAY_LIST(EXPECTED_OF_JOINT)
    case EXPECTED_DRIVE_WORK:
        return run->energy.drive_work;
    case EXPECTED_DISSIPATED:
        return run->energy.dissipated;
    case EXPECTED_CHANGE:
        return run->energy.change;
    case EXPECTED_RESIDUAL:
        return run->energy.residual;
    case EXPECTED_STEPS:
        return (double)run->steps;
    case EXPECTED_EVALUATIONS:
        return (double)run->evaluations;
    default:
        return error_number(error, expectation->number);
    }
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
// Extremes of omega and alpha of each moving body; of each joint the force, of those with play the
// impulse, the contacts, the penetration, the time in contact; the spikes of accelerations and
// forces; the energy and its residual; the error; what the run cost; the order of convergence
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
                      double value, const BodyExtremes *extremes)
{
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

static BodyExtremes extremes_of_samples(const Trajectory *run, size_t body)
{
    const Motion *start = trajectory_motion(run, 0, body);
    BodyExtremes extremes = {.omega_max.value = start->omega,
                             .omega_min.value = start->omega,
                             .alpha_max.value = start->alpha,
                             .alpha_min.value = start->alpha};
    for (size_t k = 1; k < run->sample_count; k++) {
        const Motion *motion = trajectory_motion(run, k, body);
        extremes.omega_max.value = fmax(extremes.omega_max.value, motion->omega);
        extremes.omega_min.value = fmin(extremes.omega_min.value, motion->omega);
        extremes.alpha_max.value = fmax(extremes.alpha_max.value, motion->alpha);
        extremes.alpha_min.value = fmin(extremes.alpha_min.value, motion->alpha);
    }
    return extremes;
}

static void check_measure_add_bodies(CheckAdd *work, const Trajectory *run, BackendKind backend)
{
    static const char *const NAMES[2][4] = {
        {"omega_max_rad_s", "omega_min_rad_s", "alpha_max_rad_s2", "alpha_min_rad_s2"},
        {"omega_max_at_samples_rad_s", "omega_min_at_samples_rad_s", "alpha_max_at_samples_rad_s2",
         "alpha_min_at_samples_rad_s2"},
    };
    const char *const *names = NAMES[is_by_samples(backend) ? 1 : 0];
    for (size_t i = 0; i < run->body_count; i++) {
        if (linkage_is_driven(&run->linkage, (int)i)) {
            continue;
        }
        const char *name = work->scenario->linkage.bodies[i].name;
        const BodyExtremes body =
            is_by_samples(backend) ? extremes_of_samples(run, i) : run->bodies[i];
        const double scale = work->speeds.turning[i];
        add_real(work, run, name, names[0], body.omega_max.value, scale);
        add_real(work, run, name, names[1], body.omega_min.value, scale);
        add_alpha(work, run, i, names[2], body.alpha_max.value, &body);
        add_alpha(work, run, i, names[3], body.alpha_min.value, &body);
    }
}

static double force_at_samples(const Trajectory *run, size_t joint)
{
    double force = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        force = fmax(force, trajectory_state(run, k, joint)->force);
    }
    return force;
}

// One number of a joint; the largest force of one without play as often from its samples.
static void add_joint_number(CheckAdd *work, const Trajectory *run, BackendKind backend,
                             JointNumberId id, size_t joint)
{
    const JointNumber *number = &JOINT_NUMBERS[id];
    const Joint *of = &work->scenario->linkage.joints[joint];
    const double value = joint_numbers_find(id, run, joint).value;
    char name[CHECK_NAME_SIZE];
    snprintf(name, sizeof name, "%s%s", number->keys[linkage_is_torsional(of)], number->check_end);
    // the reference looks for the peak of a contact between its steps
    if (id == JOINT_NUMBER_FORCE_MAX && is_by_samples(backend) && !linkage_has_play(of)) {
        check_measure_add_force(work, run, of, "force_max_at_samples_N",
                                force_at_samples(run, joint), 0.0);
    } else if (number->kind == JOINT_NUMBER_OF_COUNT) {
        add_count(work, run, of->name, name, (size_t)value);
    } else if (number->kind == JOINT_NUMBER_OF_FORCE) {
        check_measure_add_force(work, run, of, name, value, 0.0);
    } else {
        add_real(work, run, of->name, name, value, 0.0);
    }
}

static void add_joints(CheckAdd *work, const Trajectory *run, BackendKind backend)
{
    for (size_t i = 0; i < run->joint_count; i++) {
        const bool has_play = linkage_has_play(&work->scenario->linkage.joints[i]) &&
                              OPTIONS_BACKEND_HAS_PLAY[backend];
        for (JointNumberId id = 0; id < JOINT_NUMBER_COUNT; id++) {
            if (has_play || !JOINT_NUMBERS[id].is_of_play) {
                add_joint_number(work, run, backend, id, i);
            }
        }
    }
}

// Of the signals that were looked at for spikes: how many there are, and the mean size of the
// strongest. Widths and impulses come from a history that is thinned where it is nearly straight,
// so that rounding now and then moves them by what the thinning allows.
static double mean_size(const SignalSpikes *found)
{
    double sum = 0.0;
    for (size_t i = 0; i < found->kept; i++) {
        sum += fabs(found->spikes[i].value) / (double)found->kept;
    }
    return sum;
}

static void add_spikes(CheckAdd *work, const Trajectory *run, BackendKind backend)
{
    const Linkage *linkage = &work->scenario->linkage;
    // the reference's chosen steps meet the peak of a spike at varying distances
    for (size_t i = 0; !is_by_samples(backend) && i < run->body_count; i++) {
        const char *name = linkage->bodies[i].name;
        const SignalSpikes *found = &run->alpha_spikes[i];
        if (!linkage_is_driven(&run->linkage, (int)i) && found->is_known) {
            add_count(work, run, name, "alpha_spikes", found->count);
            add_real(work, run, name, "alpha_spikes_mean_rad_s2", mean_size(found),
                     found->threshold);
        }
    }
    for (size_t i = 0; !is_by_samples(backend) && i < run->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const SignalSpikes *found = &run->force_spikes[i];
        if (found->is_known) {
            add_count(work, run, joint->name, "force_spikes", found->count);
            check_measure_add_force(work, run, joint,
                                    linkage_is_torsional(joint) ? "force_spikes_mean_N_m"
                                                                : "force_spikes_mean_N",
                                    mean_size(found), found->threshold);
        }
    }
}

static void add_energy(CheckAdd *work, const Trajectory *run)
{
    const Energy *energy = &run->energy;
    const double scale = fmax(fabs(energy->drive_work), work->energy);
    add_real(work, run, "energy", "drive_work_J", energy->drive_work, scale);
    if (work->scenario->linkage.load_count > 0) {
        add_real(work, run, "energy", "load_work_J", energy->load_work, scale);
    }
    add_real(work, run, "energy", "dissipated_J", energy->dissipated, scale);
    add_real(work, run, "energy", "change_J", energy->change, scale);
    add_real(work, run, "energy", "residual_J", energy->residual, scale);
    if (law_has_friction(work->scenario)) {
        add_real(work, run, "energy", "friction_J", energy->friction, scale);
    }
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

static void add_cost(CheckAdd *work, const Trajectory *run)
{
    add_effort(work, run, "steps", run->steps);
    add_effort(work, run, "evaluations", run->evaluations);
    add_count(work, run, "cost", "constraint_rows", run->constraint_rows);
    add_count(work, run, "cost", "contact_rows", run->contact_rows);
    add_count(work, run, "cost", "fallback_rows", run->fallback_rows);
    check_measure_add(work, run, "", "hash", (CheckMetric){.kind = CHECK_HASH, .hash = run->hash});
}

// Errors are shares already: what rounding may change of them is a share of 1, and the truth that
// they are against may itself be off by its uncertainty.
static void check_add_error(CheckAdd *work, const Trajectory *run, const TrajectoryError *error,
                            double uncertainty)
{
    const double values[] = {error->max, error->omega_max, error->omega_rms, error->alpha_max};
    static const char *const NAMES[] = {"max_1", "omega_max_1", "omega_rms_1", "alpha_max_1"};
    for (int i = 0; i < 4; i++) {
        check_measure_add(work, run, "error", NAMES[i],
                          (CheckMetric){.kind = CHECK_REAL,
                                        .value = values[i],
                                        .scale = values[i],
                                        .floor = ROUNDING + uncertainty +
                                                 (i == 3 ? alpha_rounding(run, 1.0) : 0.0)});
    }
}

// The errors that the tolerance of a case is of, where they are not those of the motion.
static void add_error_of_kind(CheckAdd *work, const Trajectory *run, const TrajectoryError *error,
                              double uncertainty)
{
    const ToleranceOf kind = work->scenario->run.tolerance_of;
    static const char *const NAMES[] = {"force_max_1", "peak_force_max_1", "peak_alpha_max_1"};
    const double values[] = {error->force_max, error->peak_force_max, error->peak_alpha_max};
    for (int i = 0; kind != TOLERANCE_OF_MOTION && i < 3; i++) {
        const bool is_its = (kind == TOLERANCE_OF_FORCES) == (i == 0);
        // without play there are no forces of contacts
        if (is_its && !isnan(values[i])) {
            check_measure_add(work, run, "error", NAMES[i],
                              (CheckMetric){.kind = CHECK_REAL,
                                            .value = values[i],
                                            .scale = values[i],
                                            .floor = ROUNDING + uncertainty +
                                                     (i == 2 ? alpha_rounding(run, 1.0) : 0.0)});
        }
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

// Adds extremes, spikes, contacts, energy and cost of a run.
static void check_add_run(CheckAdd *work, const Trajectory *run, BackendKind backend)
{
    check_measure_add_bodies(work, run, backend);
    add_joints(work, run, backend);
    add_spikes(work, run, backend);
    add_energy(work, run);
    add_cost(work, run);
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
        check_measure_note_failure(work->measure, run);
        return;
    }
    check_add_error(work, run, &error, plan->uncertainty);
    add_error_of_kind(work, run, &error, plan->uncertainty);
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
    // in the same order: extremes and spikes; forces, contacts and spikes; energy, cost,
    // errors and orders
    enum { OF_BODY = 6, OF_JOINT = JOINT_NUMBER_COUNT + 2, OF_RUN = 18, GROUPS = 2 };
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

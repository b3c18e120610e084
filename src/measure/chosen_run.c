// Chooses the step of ODE, or of another engine, that gives the error asked for, and runs it.
//
// No error is extrapolated: trials at falling steps are held against the truth at every sample, and
// the first that holds the tolerance up to the horizon is the run. See docs/stepping.md.
//
// The work of all trials is bounded by N world steps. A trial of step h costs c T / h, c known from
// the ones before; it is made only where as much is left afterwards, so that a run of that step can
// always be had whole. The last trial is as fine as what is left allows, and is not given up: it is
// the result, up to where it held.
//
// Another engine runs the whole motion before its first sample is seen. Its trials all cost what a
// run does, so its steps fall faster.
#include "measure/chosen_run.h"
#include "base/clock.h"
#include "base/zeroed.h"
#include "contact/touch.h"
#include "measure/error.h"
#include "measure/truth.h"
#include "model/distance.h"
#include "model/lock.h"
#include "model/scale.h"
#include "model/scenario.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct StepChoice {
    const Scenario *scenario; // outlives the choice
    double first_step_s;      // the coarsest worth a trial
    bool is_smooth;           // whether errors fall as the order says: nothing touches
    double order;             // of the stepping, where it is
} StepChoice;

// The part of a run in which a truth is sure enough, and what holds after it.
typedef struct TrialWindow {
    double until_s;     // the end of the run, the truth's horizon, or before it
    double uncertainty; // 1, of the truth up to there
    bool is_uncertain;  // it ends where the uncertainty grows too large
    double horizon_s;   // where it does, the truth's horizon or the end of the run
    double behind;      // 1: up to there, times the tolerance, what a run may be away
} TrialWindow;

// What a second of motion costs, in evaluations of the contacts' forces.
typedef struct Work {
    double fixed;   // 1/s, at any step
    double stepped; // 1, times a step's length that of the steps
} Work;

// What a trial is held against, and when it is not worth running on.
typedef struct TrialRule {
    const Truth *truth;
    const DistanceMeasure *measure; // of the truth, as the next
    const ForceMeasure *forces;
    TrialWindow window; // in which errors count
    double tolerance;   // 1
    ToleranceOf kind;   // of which error it is
    bool is_last;       // it is run to its end, though it misses the tolerance
    bool is_smooth;     // likewise, for its largest error says which step is next
} TrialRule;

typedef struct Trial {
    double step_s;
    Trajectory *run;   // owned; incomplete where it failed or was given up
    bool is_given_up;  // it missed the tolerance
    double held_error; // 1, largest while it held the tolerance
    double held_s;     // the last sample up to which it did; 0: not even the first
    double error;      // 1, at the sample after that; 0 where there is none
    double worst;      // 1, largest on the whole window, where the trial is run to its end
    bool holds;        // the tolerance on the whole window, and what is allowed behind it
} Trial;

// The next step to be tried.
//
// One that costs a little more. A trial ends at the first sample that is above the tolerance, which
// is mostly soon: on random mechanisms a walk in small strides comes to a step that will do at the
// cost of little more than that one run. To jump ahead as the order says takes fewer trials and
// more work, for errors do not fall as the order says: grazing impacts come and go. Where all
// joints are ideal they do: a trial is run to its end, and the next step follows from its largest
// error and the order.
//
// A second of motion costs a + b / h: the samples, and the contacts where they are integrated in
// steps of their own, cost a at any step, the world steps b / h. Where b / h is little, a much
// finer step costs little more.

// work of a step over that of the next one, where it missed at once and where it missed at the end
static const double DEARER_EARLY = 0.8;
static const double DEARER_LATE = 0.7;
static const double DEARER_WHOLE = 0.4; // where every trial is a whole run

// in evaluations of the contacts' forces, as instructions of the paper's case have it
static const double WORLD_STEP_WORK = 16.0;
static const double SAMPLE_WORK = 2.0;

// Where it missed at the very first sample, no impact lies before, and errors there fall with the
// step or faster: the next one is shorter by a root of how many times the tolerance that error was.
// So the coarsest steps, each of which may hold many impacts, are passed over.
static const double FIRST_SAMPLE_POWER = 0.5;

// of a step, what the next one has at least: the coarsest say little about what a second costs
static const double STEP_SHARE_LEAST = 0.1;

// a failed trial gives no hint of the step that succeeds
static const double AFTER_FAILURE = 0.5;

// The first step is coarser than most that will do: a trial of it costs next to nothing.
static const double FIRST_STEPS = 20.0;    // of the drive's turn, or of a run without a drive
static const double FIRST_CONTACTS = 64.0; // half-periods of a contact, if that is less
static const double LEAST_STEPS = 10.0;    // of any run

// Where the order says it, a step this much shorter than what would just do; and within these
// shares of the last one, for the coarsest steps are beyond what the order says.
static const double ORDER_SHARE = 0.9;
static const double ORDER_LEAST = 0.4;
static const double ORDER_MOST = 0.9;

// How fast the sides of a place may meet: as the fastest point of the linkage, or at a turn as the
// faster of its two bodies turns at the most.
static double meeting_speed(const Scenario *scenario, const Touch *place)
{
    SpeedScale scale = scale_speeds(scenario);
    double speed = touch_is_torque(place) ? 0.0 : scale.moving;
    for (int side = 0; touch_is_torque(place) && side < 2; side++) {
        const int body = linkage_end(&scenario->linkage.joints[place->joint], side).body;
        speed = body == LINKAGE_GROUND ? speed : fmax(speed, scale.turning[body]);
    }
    scale_free(&scale);
    return speed;
}

// A depth of a contact: a tenth of the clearance, or of stops and of the ends of a coordinate what
// their bodies would press in. Laws of these are powers.
static double contact_depth(const Scenario *scenario, const Touch *place, double mass)
{
    static const double DEPTH = 0.1;
    const Joint *joint = &scenario->linkage.joints[place->joint];
    if (joint_is_loose(joint->kind)) {
        return fmin(DEPTH * linkage_radial_clearance(joint),
                    0.5 * force_law_depth_limit(&place->law));
    }
    const double speed = meeting_speed(scenario, place);
    const double power = place->law.exponent + 1.0;
    return pow(0.5 * power * mass * speed * speed / place->law.stiffness, 1.0 / power);
}

// The shortest half-period of contacts at places that the response has been taken with, s.
static double shortest_time(const Scenario *scenario, const Response *response, const Touch *places,
                            size_t count)
{
    double shortest_s = INFINITY;
    for (size_t i = 0; i < count; i++) {
        const size_t row = response_first_row(response, i);
        // the first row of a line is along its normal
        const double along = response_mass(response, row, (Vec2){1.0, 0.0});
        const double mass = touch_is_scalar(&places[i])
                                ? along
                                : fmin(along, response_mass(response, row, (Vec2){0.0, 1.0}));
        const double depth = contact_depth(scenario, &places[i], mass);
        shortest_s = fmin(shortest_s, M_PI * sqrt(mass / force_law_tangent(&places[i].law, depth)));
    }
    return shortest_s;
}

// The half-period of the stiffest contact, s.
static double contact_time(const Scenario *scenario)
{
    Touch *places;
    size_t count;
    Response response;
    Err unused = {ERR_NONE, ""};
    if (!touch_list(scenario, &places, &count, &unused)) {
        return INFINITY; // opening the world says what is wrong
    }
    Motion *motions = zeroed(scenario->linkage.body_count, sizeof *motions);
    linkage_start(&scenario->linkage, motions);
    touch_response(&scenario->linkage, places, count, false, &response);
    const double shortest_s = response_place(&response, motions)
                                  ? shortest_time(scenario, &response, places, count)
                                  : INFINITY;
    response_finish(&response);
    free(motions);
    free(places);
    return shortest_s;
}

// By which power of the step the error of a way of stepping falls where motion is smooth.
static double order_of(const OdeOptions *ode)
{
    switch (ode->stepping) {
    case ODE_PLAIN:
        return 1.0;
    case ODE_EXTRAPOLATED:
        return (double)ode->levels + 1.0;
    case ODE_STAGGERED:
    case ODE_STEPPING_COUNT:
        break;
    }
    return 2.0;
}

static StepChoice step_choice_begin(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    const double duration_s = scenario_duration(scenario);
    const double turn_s = drive_is_steady(&linkage->driver) ? linkage_period(linkage) : duration_s;
    const double first_s = fmin(turn_s / FIRST_STEPS, duration_s / LEAST_STEPS);
    const OdeOptions *ode = &scenario->ode;
    bool is_smooth = true;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        is_smooth = is_smooth && !linkage_has_play(&linkage->joints[i]);
    }
    return (StepChoice){
        .scenario = scenario,
        .first_step_s = fmin(first_s, FIRST_CONTACTS * contact_time(scenario)),
        .is_smooth = is_smooth,
        .order = order_of(ode),
    };
}

// The scenario at that step, stepped as trials are.
static Scenario step_choice_scenario(const StepChoice *choice, double step_s)
{
    return scenario_with_step(choice->scenario, step_s);
}

// Of one that missed the tolerance when it had come through a share of the run, 0 to 1.
static double dearer_after(double share)
{
    return DEARER_EARLY + (DEARER_LATE - DEARER_EARLY) * fmin(1.0, share);
}

static double step_choice_dearer(Work work, double step_s, double dearer)
{
    const double next_s =
        work.stepped / ((work.fixed + work.stepped / step_s) / dearer - work.fixed);
    return fmax(next_s, STEP_SHARE_LEAST * step_s);
}

static double step_choice_after_first_sample(double step_s, double excess)
{
    return step_s * fmax(pow(excess, -FIRST_SAMPLE_POWER), STEP_SHARE_LEAST);
}

// The step after one whose largest error in the whole run was that many times the tolerance, where
// errors fall as the order says.
static double step_choice_by_order(const StepChoice *choice, double step_s, double excess)
{
    const double share = ORDER_SHARE * pow(excess, -1.0 / choice->order);
    return step_s * fmin(fmax(share, ORDER_LEAST), ORDER_MOST);
}

// The step after one that the solver failed at.
static double step_choice_after_failure(double step_s)
{
    return AFTER_FAILURE * step_s;
}

// A trial: whether a run of one step holds the tolerance, and up to when.
//
// The error at a sample is that of model/distance.c against the truth's, and with it the truth's
// own uncertainty with a margin, so that what is held is an upper bound.
//
// The truth's uncertainty U belongs to its horizon T and was less before. How it grew shows in the
// distance to a run of the reference at another tolerance, d(t), the largest so far:
//     U(t) = U max(d(t) / d(T), 1 / growth)
// with the growth of the fastest of all perturbations up to T: no error has grown more.
//
// Where U(t) grows above a tenth of the tolerance nothing can be said to hold any more. There a run
// still may not be further away than ten times U: as far as the truth is known it is as good as one
// for a larger tolerance.

// a reference is rarely off by more than it says, and by three times that hardly ever
static const double TRUTH_MARGIN = 3.0;

typedef struct Watcher {
    const TrialRule *rule;
    Trial *trial;
    bool is_over; // the tolerance was exceeded
} Watcher;

static double apart_at(const Watcher *watcher, const Trajectory *run, size_t sample)
{
    const Trajectory *truth = watcher->rule->truth->trajectory;
    return watcher->rule->kind == TOLERANCE_OF_FORCES
               ? error_forces_apart(watcher->rule->forces, run, truth, sample)
               : distance_apart(watcher->rule->measure, distance_motion_at(run, sample),
                                distance_motion_at(truth, sample), NULL);
}

static bool chosen_run_look(const Trajectory *trajectory, size_t sample, void *context, Err *err)
{
    Watcher *watcher = context;
    const TrialRule *rule = watcher->rule;
    const Trajectory *truth = rule->truth->trajectory;
    Trial *trial = watcher->trial;
    const double time_s = truth->times[sample];
    const bool is_behind = time_s > rule->window.until_s;
    // how the uncertainty of forces grows is not known
    const bool is_of_interest =
        !is_behind || (rule->kind == TOLERANCE_OF_MOTION && rule->window.is_uncertain &&
                       time_s <= rule->window.horizon_s);
    const bool runs_on = rule->is_last || rule->is_smooth;
    if (!is_of_interest || (watcher->is_over && !runs_on)) {
        return true;
    }
    const double apart = apart_at(watcher, trajectory, sample);
    if (is_behind && apart <= rule->window.behind * rule->tolerance) {
        return true;
    }
    const double bound = apart + TRUTH_MARGIN * rule->window.uncertainty;
    trial->worst = is_behind ? trial->worst : fmax(trial->worst, bound);
    if (watcher->is_over) {
        return true;
    }
    if (!is_behind && bound <= rule->tolerance) {
        trial->held_s = time_s;
        trial->held_error = fmax(trial->held_error, bound);
        return true;
    }
    watcher->is_over = true;
    trial->error = bound;
    trial->is_given_up = !runs_on;
    return runs_on || err_set(err, ERR_SOLVER, "the step is too coarse");
}

// The last sample up to which the peaks of a run hold the tolerance, s; 0: not even the first.
static double peaks_held_until(const TrialRule *rule, const Trajectory *run)
{
    const Trajectory *truth = rule->truth->trajectory;
    const double most = rule->tolerance - TRUTH_MARGIN * rule->window.uncertainty;
    size_t held = 0;
    size_t missed = truth->sample_count;
    while (missed - held > 1) {
        const size_t middle = held + (missed - held) / 2;
        const double until_s = fmin(truth->times[middle], rule->window.until_s);
        *(error_of_peaks(run, truth, until_s) <= most ? &held : &missed) = middle;
    }
    return truth->times[held];
}

// Peaks are compared when the whole run is known. Returns whether they hold the tolerance.
static bool trial_judge_peaks(const TrialRule *rule, Trial *trial)
{
    const double apart = error_of_peaks(trial->run, rule->truth->trajectory, rule->window.until_s);
    const double bound = apart + TRUTH_MARGIN * rule->window.uncertainty;
    trial->worst = bound;
    if (bound <= rule->tolerance) {
        trial->held_s = rule->window.until_s;
        trial->held_error = bound;
        return true;
    }
    trial->error = bound;
    trial->held_s = peaks_held_until(rule, trial->run);
    trial->held_error = rule->tolerance;
    trial->is_given_up = !rule->is_last && !rule->is_smooth;
    return false;
}

static Trial trial_make(const Scenario *scenario, BackendKind backend, const TrialRule *rule,
                        RunWatch watch, const RunProbe *probe)
{
    Trial trial = {.step_s = scenario->run.step};
    Watcher watcher = {.rule = rule, .trial = &trial};
    const RunGuard guard = {chosen_run_look, &watcher};
    const bool is_of_peaks = rule->kind == TOLERANCE_OF_PEAKS;
    trial.run =
        run_guarded(scenario, registry_solver(backend), watch, probe, is_of_peaks ? NULL : &guard);
    trial.holds = trial.run->is_complete && !watcher.is_over &&
                  (!is_of_peaks || trial_judge_peaks(rule, &trial));
    return trial;
}

// Runs the scenario, which has its step, and looks at every sample of it. The probe may be NULL.
static void trial_finish(Trial *trial)
{
    trajectory_destroy(trial->run);
    trial->run = NULL;
}

static TrialWindow shorten(const Trajectory *truth, const Trajectory *other, double growth,
                           TrialWindow whole, double most)
{
    DistanceMeasure measure = distance_measure(truth);
    double *so_far = zeroed(truth->sample_count, sizeof *so_far);
    double largest = 0.0;
    for (size_t k = 0; k < truth->sample_count && truth->times[k] <= whole.until_s; k++) {
        largest = fmax(largest, distance_apart(&measure, distance_motion_at(other, k),
                                               distance_motion_at(truth, k), NULL));
        so_far[k] = largest;
    }
    distance_finish(&measure);
    TrialWindow window = {.horizon_s = whole.until_s, .behind = whole.uncertainty / most};
    for (size_t k = 0; largest > 0.0 && k < truth->sample_count; k++) {
        const double uncertainty = whole.uncertainty * fmax(so_far[k] / largest, 1.0 / growth);
        window.is_uncertain = truth->times[k] <= whole.until_s && !(uncertainty <= most);
        if (truth->times[k] > whole.until_s || window.is_uncertain) {
            break;
        }
        window.until_s = truth->times[k];
        window.uncertainty = uncertainty;
    }
    free(so_far);
    return window;
}

// The longest window from the start in which the uncertainty of the truth is at most `most`. It is
// empty, until_s being 0, where the truth is nowhere that sure. Another run of the reference is
// made only where the truth is not that sure up to its horizon.
static TrialWindow trial_window(const Scenario *scenario, const Truth *truth, double most,
                                RunWatch watch)
{
    const double duration_s = scenario_duration(scenario);
    const TrialWindow whole = {
        .until_s = truth->is_limited ? fmin(truth->horizon_s, duration_s) : duration_s,
        .uncertainty = truth->uncertainty,
    };
    if (truth->uncertainty <= most) {
        return whole;
    }
    if (!isfinite(truth->uncertainty)) {
        return (TrialWindow){.is_uncertain = true};
    }
    const Scenario other = truth_at_other_tolerance(scenario);
    Trajectory *run = run_motion(&other, registry_solver(BACKEND_REFERENCE), watch);
    const TrialWindow window = run->is_complete
                                   ? shorten(truth->trajectory, run, truth->growth, whole, most)
                                   : (TrialWindow){.is_uncertain = true};
    trajectory_destroy(run);
    return window;
}

// errors below this multiple of the reference's uncertainty are dominated by it
static const double TRUTH_SHARE = 0.1;

// world steps per step, before a trial has shown it: a gear of 2
static const double COST_AT_FIRST = 2.0;

// trials that fail at the same time, within a share of the run
enum { FAILURES_ALIKE = 9 };
static const double ONE_PLACE = 0.01;

// a step this near to that of a good trial is not tried instead
static const double NEAR_STEP = 1.2;

// 1: of what is left for the last trial, whose cost is known by those before
static const double LAST_SHARE = 0.95;

// steps for the last trial from one to its half
static const double LAST_RUNGS = 3.0;

// 1: of the budget, which has to be spent before the trials show what a step takes
static const double BUDGET_KNOWN = 0.05;

// What the last two trials that were whole runs took: its time is a + b times its steps, a being
// what an engine's contacts take, which are integrated in steps of their own.
typedef struct Pace {
    size_t count;
    double steps[2]; // the last one's first
    double time_s[2];
} Pace;

typedef struct Chosen {
    const Scenario *scenario;
    BackendKind backend;
    const Truth *truth;
    const RunProbe *probe;
    ChosenWatch watch;
    StepChoice choice;
    DistanceMeasure measure; // of the truth, as the next
    ForceMeasure forces;
    double started_s;  // by the clock
    double computed_s; // of processor time, when the trials began
    TrialWindow window;
    double cost; // world steps to a step
    Pace pace;
    size_t trials;
    size_t steps; // of all trials so far
    size_t evaluations;
    double moved_s;  // of motion
    double engine_s; // that other processes took
    double wall_s;
    double best_step_s; // of the trial that held longest; 0: none did at all
    double best_held_s;
    size_t failures; // one after the other, at the same time
    double failed_s; // where
} Chosen;

Scenario chosen_run_scenario(const Scenario *scenario, double step_s)
{
    const StepChoice choice = step_choice_begin(scenario);
    return step_choice_scenario(&choice, step_s);
}

// A failed run.
static Trajectory *chosen_run_fail(const Chosen *chosen, const char *message)
{
    Trajectory *none = trajectory_create(chosen->scenario, OPTIONS_BACKENDS[chosen->backend]);
    snprintf(none->message, sizeof none->message, "%s", message);
    none->trials = chosen->trials;
    none->steps = chosen->steps;
    none->evaluations = chosen->evaluations;
    none->wall_s = chosen->wall_s;
    return none;
}

static void pass_progress(double share, double wall_s, void *context)
{
    (void)wall_s;
    const Chosen *chosen = context;
    chosen->watch.run.progress(share, clock_now_s() - chosen->started_s, chosen->watch.run.context);
}

// What watches a run goes by the time of all. How far another engine has come is not known before
// its run is over.
static RunWatch watch_of(Chosen *chosen)
{
    const bool is_shown = chosen->watch.run.progress != NULL && !options_is_engine(chosen->backend);
    return (RunWatch){is_shown ? pass_progress : NULL, chosen};
}

// Reports what begins.
static RunWatch chosen_run_begin(Chosen *chosen, size_t trial, double step_s)
{
    if (chosen->watch.begin != NULL) {
        chosen->watch.begin(trial, step_s, chosen->watch.run.context);
    }
    return watch_of(chosen);
}

// Why no error can be measured against this truth; false where it can.
static bool lacks_truth(const Chosen *chosen, char *message, size_t size)
{
    const Truth *truth = chosen->truth;
    const double tolerance = chosen->scenario->run.tolerance;
    const bool is_made = truth->trajectory->is_complete;
    if (!is_made || truth->message[0] != '\0') {
        // no step passes a lock
        const Lock lock = lock_met(chosen->scenario, truth->trajectory->duration_s);
        snprintf(message, size, "no step can be chosen, because the reference failed: %.600s%s",
                 is_made ? truth->message : truth->trajectory->message,
                 lock.state == LOCK_FOUND ? "" : "; give run.step");
        return true;
    }
    if (!(chosen->window.until_s > 0.0) && truth->uncertainty > TRUTH_SHARE * tolerance) {
        snprintf(message, size,
                 "run.tolerance %.3g is below ten times the uncertainty of the reference, %.2g; "
                 "allowed: %.2g or more, or a reference.tolerance below %.2g",
                 tolerance, truth->uncertainty, truth->uncertainty / TRUTH_SHARE,
                 chosen->scenario->reference.tolerance);
        return true;
    }
    const ToleranceOf kind = chosen->scenario->run.tolerance_of;
    if (kind != TOLERANCE_OF_MOTION && !(chosen->window.uncertainty <= TRUTH_SHARE * tolerance)) {
        snprintf(message, size,
                 "run.tolerance %.3g is below ten times the uncertainty of the reference in %s, "
                 "%.2g; allowed: %.2g or more, or run.tolerance-of: motion",
                 tolerance, OPTIONS_TOLERANCES_OF[kind], chosen->window.uncertainty,
                 chosen->window.uncertainty / TRUTH_SHARE);
        return true;
    }
    if (!(truth->trajectory->times[1] <= chosen->window.until_s)) {
        snprintf(message, size,
                 "no step can be chosen, because the motion cannot be predicted up to the first "
                 "sample, %.4g ms; take more samples, or give run.step",
                 1e3 * truth->trajectory->times[1]);
        return true;
    }
    return false;
}

static void pace_take(Pace *pace, double steps, double time_s)
{
    pace->steps[1] = pace->steps[0];
    pace->time_s[1] = pace->time_s[0];
    pace->steps[0] = steps;
    pace->time_s[0] = time_s;
    pace->count++;
}

// b, s; at most all that the last one took.
static double pace_of_step(const Pace *pace)
{
    const double all = pace->time_s[0] / pace->steps[0];
    const double slope = (pace->time_s[0] - pace->time_s[1]) / (pace->steps[0] - pace->steps[1]);
    return pace->count > 1 && slope > 0.0 ? fmin(slope, all) : all;
}

static double pace_time(const Pace *pace, double steps)
{
    return pace->time_s[0] + pace_of_step(pace) * (steps - pace->steps[0]);
}

static double pace_steps(const Pace *pace, double time_s)
{
    return pace->steps[0] + (time_s - pace->time_s[0]) / pace_of_step(pace);
}

// s of processor time so far, by the trials.
static double spent_of(const Chosen *chosen)
{
    return clock_processor_s() - chosen->computed_s + chosen->engine_s;
}

// What the trial was made for, and what it cost, is known.
static void chosen_run_count(Chosen *chosen, const Trial *trial)
{
    const Trajectory *run = trial->run;
    chosen->steps += run->steps;
    chosen->evaluations += run->evaluations;
    chosen->moved_s += run->stepped_s;
    chosen->wall_s += run->wall_s;
    const bool is_failed = !run->is_complete && !trial->is_given_up;
    // where one of several mechanisms fails, it may be far ahead of what all have reached
    if (!is_failed && run->stepped_s > 0.0) {
        // what a short trial costs need not be what the rest of the run would have
        chosen->cost = fmax(chosen->cost, (double)run->steps * trial->step_s / run->stepped_s);
    }
    // one that did not begin has no steps
    if (options_is_engine(chosen->backend) && run->steps > 0) {
        chosen->engine_s += run->wall_s;
        pace_take(&chosen->pace, (double)run->steps, run->wall_s);
    }
    if (!is_failed && trial->held_s > chosen->best_held_s) {
        chosen->best_held_s = trial->held_s;
        chosen->best_step_s = trial->step_s;
    }
    if (!is_failed) {
        chosen->failures = 0;
        return;
    }
    const double near_s = ONE_PLACE * scenario_duration(chosen->scenario);
    const bool is_alike =
        chosen->failures > 0 && fabs(run->duration_s - chosen->failed_s) <= near_s;
    chosen->failures = is_alike ? chosen->failures + 1 : 1;
    chosen->failed_s = run->duration_s;
}

// World steps of a whole run of that step.
static double cost_of(const Chosen *chosen, double step_s)
{
    return chosen->cost * scenario_duration(chosen->scenario) / step_s;
}

// World steps that the budget has left, by what those of the trials took.
static double steps_in_budget(const Chosen *chosen)
{
    const double spent_s = spent_of(chosen);
    const double budget_s = chosen->watch.budget_s;
    if (budget_s == 0.0 || chosen->steps == 0 || !(spent_s > BUDGET_KNOWN * budget_s)) {
        return INFINITY;
    }
    return options_is_engine(chosen->backend)
               ? pace_steps(&chosen->pace, budget_s - spent_s)
               : (budget_s - spent_s) * (double)chosen->steps / spent_s;
}

static double steps_left(const Chosen *chosen)
{
    const size_t most = chosen->scenario->run.most_steps;
    const double left = most > chosen->steps ? (double)(most - chosen->steps) : 1.0;
    return fmax(1.0, fmin(left, steps_in_budget(chosen)));
}

// Whether the budget is used up before the steps.
static bool is_of_budget(const Chosen *chosen)
{
    const double most = (double)chosen->scenario->run.most_steps;
    return steps_in_budget(chosen) < most - (double)chosen->steps;
}

// Processor time of a run that would hold the tolerance, by the scheme's second order, where the
// budget is why there is none; else 0.
static double budget_wanted(const Chosen *chosen, const Trial *trial)
{
    if (!is_of_budget(chosen)) {
        return 0.0;
    }
    const double excess = fmax(trial->worst, trial->error) / chosen->scenario->run.tolerance;
    const double steps = cost_of(chosen, trial->step_s) * sqrt(fmax(excess, 1.0));
    return options_is_engine(chosen->backend) ? pace_time(&chosen->pace, steps)
                                              : spent_of(chosen) / (double)chosen->steps * steps;
}

static Trajectory *finish(const Chosen *chosen, Trial *trial)
{
    Trajectory *run = trial->run;
    trial->run = NULL;
    run->trials = chosen->trials;
    run->steps = chosen->steps;
    run->evaluations = chosen->evaluations;
    run->wall_s = chosen->wall_s;
    run->error_estimate = trial->held_error;
    run->estimate_s = trial->holds ? chosen->window.until_s : trial->held_s;
    run->estimate_is_cut = trial->holds && chosen->window.is_uncertain;
    run->is_short = !trial->holds;
    run->wanted_s = run->is_short ? budget_wanted(chosen, trial) : 0.0;
    const size_t length = strlen(run->label);
    const ToleranceOf kind = chosen->scenario->run.tolerance_of;
    snprintf(run->label + length, sizeof run->label - length, ", error%s%s %.3g wanted",
             kind == TOLERANCE_OF_MOTION ? "" : " of ",
             kind == TOLERANCE_OF_MOTION ? "" : OPTIONS_TOLERANCES_OF[kind],
             chosen->scenario->run.tolerance);
    return run;
}

static Trial make_trial(Chosen *chosen, double step_s, bool is_last)
{
    const double tolerance = chosen->scenario->run.tolerance;
    const Scenario scenario = step_choice_scenario(&chosen->choice, step_s);
    const TrialRule rule = {
        .truth = chosen->truth,
        .measure = &chosen->measure,
        .forces = &chosen->forces,
        .window = chosen->window,
        .tolerance = tolerance,
        .kind = chosen->scenario->run.tolerance_of,
        .is_last = is_last,
        .is_smooth = chosen->choice.is_smooth,
    };
    const Trial trial =
        trial_make(&scenario, chosen->backend, &rule,
                   chosen_run_begin(chosen, ++chosen->trials, step_s), chosen->probe);
    chosen_run_count(chosen, &trial);
    return trial;
}

// The step of the last trial: as fine as can be had, unless that is no finer than the best known.
// It is one of few, so that a budget of time, which is never quite the same, mostly leads to the
// same.
static double last_step(const Chosen *chosen)
{
    const double first_s = chosen->choice.first_step_s;
    const double steps = LAST_SHARE * steps_left(chosen);
    const double finest_s = chosen->cost * scenario_duration(chosen->scenario) / steps;
    const double halvings = floor(LAST_RUNGS * log2(first_s / finest_s)) / LAST_RUNGS;
    const double step_s = first_s * exp2(-fmax(halvings, 0.0));
    const bool is_near = chosen->best_step_s > 0.0 && step_s * NEAR_STEP >= chosen->best_step_s;
    return is_near ? chosen->best_step_s : step_s;
}

// The result where no further trial is worth it, or why there is none.
static Trajectory *end_trials(const Chosen *chosen, Trial *trial)
{
    char message[ERR_TEXT_SIZE];
    const bool is_worth_it = trial->held_s > 0.0 || is_of_budget(chosen);
    if (trial->holds || (trial->run->is_complete && is_worth_it)) {
        return finish(chosen, trial);
    }
    if (trial->run->is_complete) {
        snprintf(message, sizeof message,
                 "no step gives the error %.3g within %zu world steps: at %.3g us the first sample "
                 "has %.2g; allow more (run.most-steps), or a larger run.tolerance",
                 chosen->scenario->run.tolerance, chosen->scenario->run.most_steps,
                 1e6 * trial->step_s, trial->error);
    } else {
        snprintf(
            message, sizeof message, "%s: %.300s",
            chosen->failures == FAILURES_ALIKE
                ? "no step can be chosen, because trials at ever finer steps fail at the same time"
                : "no trial was complete within run.most-steps",
            trial->run->message);
    }
    Trajectory *none = chosen_run_fail(chosen, message);
    trial_finish(trial);
    return none;
}

// As the trials so far have shown it.
static Work work_of(const Chosen *chosen)
{
    const double samples =
        (double)chosen->truth->trajectory->sample_count / scenario_duration(chosen->scenario);
    return (Work){
        .fixed = (double)chosen->evaluations / chosen->moved_s + SAMPLE_WORK * samples,
        .stepped = WORLD_STEP_WORK * chosen->cost,
    };
}

// The step after a trial that does not hold.
static double step_after(const Chosen *chosen, const Trial *trial)
{
    const RunOptions *options = &chosen->scenario->run;
    const double excess = trial->error / options->tolerance;
    if (chosen->choice.is_smooth && trial->run->is_complete) {
        return step_choice_by_order(&chosen->choice, trial->step_s,
                                    trial->worst / options->tolerance);
    }
    if (!trial->is_given_up) {
        return step_choice_after_failure(trial->step_s);
    }
    const double share = trial->held_s / scenario_duration(chosen->scenario);
    const double dearer_s =
        step_choice_dearer(work_of(chosen), trial->step_s,
                           options_is_engine(chosen->backend) ? DEARER_WHOLE : dearer_after(share));
    return trial->held_s == 0.0 && options->tolerance_of == TOLERANCE_OF_MOTION
               ? fmin(dearer_s, step_choice_after_first_sample(trial->step_s, excess))
               : dearer_s;
}

static Trajectory *walk_to_step(Chosen *chosen)
{
    double step_s = chosen->choice.first_step_s;
    for (;;) {
        const bool is_last = 2.0 * cost_of(chosen, step_s) > steps_left(chosen);
        step_s = is_last ? last_step(chosen) : step_s;
        Trial trial = make_trial(chosen, step_s, is_last);
        if (trial.holds || is_last || chosen->failures == FAILURES_ALIKE) {
            return end_trials(chosen, &trial);
        }
        step_s = step_after(chosen, &trial);
        trial_finish(&trial);
    }
}

// With what is the same in all trials found once.
static Trajectory *chosen_run_choose(Chosen *chosen)
{
    const RunProbe *given = chosen->probe;
    RunProbe probe;
    void *shared = NULL;
    if (given != NULL && given->share != NULL) {
        shared = given->share(chosen->scenario);
        probe = *given;
        probe.shared = shared;
        chosen->probe = &probe;
    }
    chosen->measure = distance_measure(chosen->truth->trajectory);
    chosen->forces = error_forces(chosen->truth->trajectory);
    Trajectory *run = walk_to_step(chosen);
    error_forces_finish(&chosen->forces);
    distance_finish(&chosen->measure);
    free(shared);
    chosen->probe = given;
    return run;
}

// Of what the tolerance is of, in the window.
static void take_uncertainty(Chosen *chosen)
{
    const Scenario *scenario = chosen->scenario;
    if (scenario->run.tolerance_of != TOLERANCE_OF_MOTION && chosen->window.until_s > 0.0) {
        chosen->window.uncertainty =
            truth_uncertainty_of(chosen->truth, scenario, scenario->run.tolerance_of,
                                 chosen->window.until_s, watch_of(chosen));
    }
}

static Trajectory *run_at_chosen_step(const Scenario *scenario, BackendKind backend,
                                      const Truth *truth, ChosenWatch watch, const RunProbe *probe)
{
    Chosen chosen = {
        .scenario = scenario,
        .backend = backend,
        .truth = truth,
        .probe = probe,
        .watch = watch,
        .choice = step_choice_begin(scenario),
        .started_s = clock_now_s(),
        .computed_s = clock_processor_s(),
        .cost = COST_AT_FIRST,
    };
    Truth own = {.trajectory = NULL};
    if (truth == NULL) {
        own = truth_make(scenario, chosen_run_begin(&chosen, 0, 0.0));
        chosen.truth = &own;
    }
    if (chosen.truth->trajectory->is_complete) {
        chosen.window = trial_window(scenario, chosen.truth, TRUTH_SHARE * scenario->run.tolerance,
                                     watch_of(&chosen));
        take_uncertainty(&chosen);
    }
    char message[ERR_TEXT_SIZE];
    Trajectory *run = lacks_truth(&chosen, message, sizeof message)
                          ? chosen_run_fail(&chosen, message)
                          : chosen_run_choose(&chosen);
    truth_finish(&own);
    return run;
}

// A run on a backend, at its own step or a chosen one.

const RunProbe *backend_run_probe(const Scenario *scenario)
{
    return scenario->run.tolerance_of == TOLERANCE_OF_PEAKS ? &TRACER_PROBE : NULL;
}

bool backend_run_is_chosen(const Scenario *scenario, BackendKind backend)
{
    return options_is_stepped(backend) && scenario->run.step == 0.0;
}

Trajectory *backend_run(const Scenario *scenario, BackendKind backend, const Truth *truth,
                        ChosenWatch watch, const RunProbe *probe)
{
    if (backend_run_is_chosen(scenario, backend)) {
        return run_at_chosen_step(scenario, backend, truth, watch, probe);
    }
    return run_guarded(scenario, registry_solver(backend), watch.run, probe, NULL);
}

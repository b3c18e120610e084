// Which step gives the error that the user asks for?
//
// Trial runs at falling steps h, each compared with the one before. For a method of order p
//     error(h) = distance(h, s h) / (s^p - 1),  s the ratio of the two steps
// measured as errors are, in omega of all bodies over the whole run. Trials go on until the error
// is within reach of the tolerance; the step of the run itself follows from error ~ h^p. So what
// is controlled is the error of the whole run and not that of a step, with all that contacts make
// of it. Where errors do not fall as they should, the motion may not be predictable that far: then
// twins show how far it is, and the error is taken up to there. See docs/stepping.md.
#include "ode/stepping.h"

#include "contact/law.h"
#include "model/response.h"
#include "ode/pilot.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// of the tolerance: room for the estimate to be wrong
static const double AIM = 0.9;

// the run's own step may differ from the last trial's by so much, either way
static const double REACH = 2.0;

// distances that fall by less than this share of what the order says are no base for an estimate
static const double CONVERGING = 0.6;

// first steps: of the drive's turn, or of a run without one
static const double FIRST_TRIAL_STEPS = 200.0;
static const double FIRST_CONTACTS = 4.0; // half-periods of a contact, if that is less
static const double FIRST_TRIAL_STEPS_SMOOTH = 120.0;

static const double SHRINK_MOST = 8.0; // from one trial to the next
static const double MOST_EXPLAINED = 63.0;

// distances below this that do not fall any more are rounding; steps beyond the second are hours
static const double TRIAL_ROUNDING = 1e-8;
static const double STEPS_MOST = 1e8;

enum { TRIAL_MAX = 24 }; // twice finer each: far below any rounding
enum { PATIENCE = 5 };   // trials before errors have to fall as they should

// two trials that say so nearly alike how far the motion can be predicted are to be believed
static const double ALIKE = 0.1;

// rad, of the contacts' own steps at the first trial; their errors of order 4 fall as h^2 do
static const double FIRST_PHASE = 0.2;

typedef struct Chosen {
    const Scenario *scenario;
    Scenario trial; // with the way of stepping, and the step under trial
    Scenario grid;
    Pilots pilots;
    double order;
    double first_step_s;
    double window_s; // the error is that up to here
    bool is_limited; // by what can be predicted
    bool is_settled; // two trials agree on the window
    DistanceScale scales[LINKAGE_BODY_MAX];
    double estimate;
    void *state; // of the run itself, once it is under way
} Chosen;

static void chosen_close(void *state)
{
    Chosen *chosen = state;
    if (chosen == NULL) {
        return;
    }
    if (chosen->state != NULL) {
        chosen->pilots.solver->close(chosen->state);
    }
    free(chosen);
}

static void set_step(Chosen *chosen, double step_s)
{
    chosen->trial.run.step = step_s;
    chosen->trial.ode.contact_phase =
        fmin(FIRST_PHASE, FIRST_PHASE * sqrt(step_s / chosen->first_step_s));
}

// The half-period of the stiffest contact at a tenth of its clearance, s.
static double contact_time(const Scenario *scenario)
{
    static const double DEPTH = 0.1;
    const Linkage *linkage = &scenario->linkage;
    Motion motions[LINKAGE_BODY_MAX];
    Response response;
    Err unused = {ERR_NONE, ""};
    linkage_start(linkage, motions);
    if (!response_init(linkage, false, &response, &unused) || !response_place(&response, motions)) {
        return INFINITY; // opening the world says what is wrong
    }
    double shortest_s = INFINITY;
    for (size_t row = 0; row < response_play_rows(&response); row += 2) {
        const Joint *joint = &linkage->joints[response_joint(&response, row)];
        ForceLaw law;
        if (law_of_joint(scenario, joint, &law, &unused)) {
            const double mass = fmin(response_mass(&response, row, (Vec2){1.0, 0.0}),
                                     response_mass(&response, row, (Vec2){0.0, 1.0}));
            const double depth =
                fmin(DEPTH * linkage_radial_clearance(joint), 0.5 * force_law_depth_limit(&law));
            shortest_s = fmin(shortest_s, M_PI * sqrt(mass / force_law_tangent(&law, depth)));
        }
    }
    return shortest_s;
}

static void choose_stepping(Chosen *chosen)
{
    const Scenario *scenario = chosen->scenario;
    const bool has_play = scenario_has_clearance(scenario);
    const Linkage *linkage = &scenario->linkage;
    const double turn_s =
        linkage->driver.is_present ? linkage_period(linkage) : scenario_duration(scenario);
    chosen->grid = distance_grid(scenario);
    chosen->pilots.solver = has_play ? &STEPPING_IMPULSE : &STEPPING_EXTRAPOLATED;
    chosen->order = has_play ? 2.0 : (double)scenario->ode.levels + 1.0;
    chosen->first_step_s = turn_s / (has_play ? FIRST_TRIAL_STEPS : FIRST_TRIAL_STEPS_SMOOTH);
    chosen->first_step_s = fmin(chosen->first_step_s, scenario_duration(scenario) / 10.0);
    chosen->first_step_s = fmin(chosen->first_step_s, FIRST_CONTACTS * contact_time(scenario));
    chosen->window_s = scenario_duration(scenario);
    chosen->trial = scenario_with_step(scenario, chosen->first_step_s);
}

static bool chosen_open(const Scenario *scenario, void **state, Err *err)
{
    Chosen *chosen = calloc(1, sizeof *chosen);
    assert(chosen != NULL);
    chosen->scenario = scenario;
    choose_stepping(chosen);
    set_step(chosen, chosen->first_step_s);
    // what no step can mend shows here
    void *first = NULL;
    if (!chosen->pilots.solver->open(&chosen->trial, &first, err)) {
        free(chosen);
        return false;
    }
    chosen->pilots.solver->close(first);
    *state = chosen;
    return true;
}

// The largest distance of two trials up to the window's end; NAN where they cannot be compared.
static double trial_distance(const Chosen *chosen, const Trajectory *fine, const Trajectory *coarse)
{
    if (fine == NULL || coarse == NULL) {
        return NAN;
    }
    double largest = 0.0;
    for (size_t k = 0; k < fine->sample_count && k < coarse->sample_count; k++) {
        if (fine->times[k] <= chosen->window_s) {
            const double distance = distance_at(coarse, fine, k, chosen->scales);
            largest = distance > largest || isnan(distance) ? distance : largest;
        }
    }
    return largest;
}

// The error of the finer of two trials from their distance: divided by no more than an eighth of
// the step explains at second order, for below that lie other errors than the step's.
static double error_of(const Chosen *chosen, double distance, double ratio)
{
    return distance / fmin(MOST_EXPLAINED, pow(ratio, chosen->order) - 1.0);
}

// What the trials have shown so far.
typedef struct Trials {
    Trajectory *runs[3]; // the last three, the finest first; NULL where a solver failed
    double error;        // of the finest; NAN where it cannot be told
    bool is_rounding;    // finer steps would not help
    bool is_converging;  // the distances fall as the order says
} Trials;

static void judge(const Chosen *chosen, Trials *trials)
{
    Trajectory *const *runs = trials->runs;
    trials->error = NAN;
    trials->is_converging = false;
    const double distance = trial_distance(chosen, runs[0], runs[1]);
    if (isnan(distance)) {
        return;
    }
    const double ratio = runs[1]->step_s / runs[0]->step_s;
    trials->error = error_of(chosen, distance, ratio);
    const double before = trial_distance(chosen, runs[1], runs[2]);
    if (!isnan(before)) {
        const double error_before = error_of(chosen, before, runs[2]->step_s / runs[1]->step_s);
        trials->is_rounding = distance >= before && before < TRIAL_ROUNDING;
        const double fallen = log(error_before / trials->error) / log(ratio);
        // two steps below the tolerance need not fall as h^p to be good enough
        trials->is_converging = fallen >= CONVERGING * chosen->order ||
                                fmax(distance, before) <= AIM * chosen->scenario->run.tolerance;
    }
}

// How far the window may reach at the next look: twice as far as at the last one that limited it.
static double longest_window(const Chosen *chosen)
{
    const double duration_s = scenario_duration(chosen->scenario);
    return chosen->is_limited ? fmin(duration_s, 2.0 * chosen->window_s) : duration_s;
}

static void next_trial(Chosen *chosen, Trials *trials, double step_s)
{
    trajectory_destroy(trials->runs[2]);
    trials->runs[2] = trials->runs[1];
    trials->runs[1] = trials->runs[0];
    set_step(chosen, step_s);
    const double after_s = chosen->is_settled
                               ? chosen->window_s + scenario_sample_time(&chosen->grid, 1)
                               : longest_window(chosen);
    trials->runs[0] = pilot_run(&chosen->pilots, &chosen->trial, &chosen->grid, after_s);
    if (trials->runs[0] != NULL && !chosen->is_limited) {
        distance_scales(trials->runs[0], chosen->scales);
    }
    judge(chosen, trials);
}

// How far the motion can be predicted, from twins of the trial under way.
static void limit_window(Chosen *chosen, Trials *trials)
{
    Scenario even = chosen->trial;
    // twins must take the very same steps
    even.ode.gear = 1;
    const double duration_s = scenario_duration(chosen->scenario);
    const double horizon_s = pilot_horizon(&chosen->pilots, &even, &chosen->grid, chosen->scales,
                                           longest_window(chosen));
    if (!(horizon_s > 0.0)) {
        return; // the trial itself fails: the next one may not
    }
    chosen->is_settled = chosen->is_limited && horizon_s < duration_s &&
                         fabs(horizon_s - chosen->window_s) <= ALIKE * horizon_s;
    chosen->is_limited = horizon_s < duration_s;
    chosen->window_s = horizon_s;
    judge(chosen, trials);
}

static void finish_trials(Trials *trials)
{
    for (int i = 0; i < 3; i++) {
        trajectory_destroy(trials->runs[i]);
    }
}

// The step that comes after a trial: as far down as the error calls for.
static double finer_step(const Chosen *chosen, const Trials *trials)
{
    const double aim = AIM * chosen->scenario->run.tolerance;
    const double step_s = chosen->trial.run.step;
    if (isnan(trials->error) || !trials->is_converging) {
        return step_s / 2.0;
    }
    const double wanted = pow(trials->error / aim, 1.0 / chosen->order) / REACH;
    return step_s / fmin(SHRINK_MOST, fmax(2.0, wanted));
}

// Makes trials until the error of one is in reach of the tolerance, then sets the run's step.
static bool choose_step(Chosen *chosen, Err *err)
{
    const double aim = AIM * chosen->scenario->run.tolerance;
    const double reach = pow(REACH, chosen->order);
    Trials trials = {.error = NAN};
    double step_s = chosen->first_step_s;
    bool is_found = false;
    const double least_s = scenario_duration(chosen->scenario) / STEPS_MOST;
    for (int i = 0; i < TRIAL_MAX && !is_found && !trials.is_rounding && step_s > least_s; i++) {
        next_trial(chosen, &trials, step_s);
        const bool is_open = chosen->is_limited && !chosen->is_settled;
        if (i >= PATIENCE && trials.runs[2] != NULL && (!trials.is_converging || is_open)) {
            limit_window(chosen, &trials);
        }
        is_found = trials.is_converging && trials.error <= reach * aim &&
                   (!chosen->is_limited || chosen->is_settled);
        step_s = is_found ? chosen->trial.run.step : finer_step(chosen, &trials);
    }
    const double error = trials.error;
    finish_trials(&trials);
    if (!is_found && chosen->pilots.failure.kind != ERR_NONE) {
        *err = chosen->pilots.failure;
        err_prefix(err, "no step will do, not the last one tried");
        return false;
    }
    if (!is_found) {
        return err_set(err, ERR_SOLVER,
                       "no step gives the tolerance %.3g: at %.3g us the error is still some %.3g",
                       chosen->scenario->run.tolerance, 1e6 * chosen->trial.run.step, error);
    }
    const double factor = pow(aim / fmax(error, 1e-300), 1.0 / chosen->order);
    set_step(chosen, fmin(chosen->first_step_s, step_s * fmin(REACH, fmax(1.0 / REACH, factor))));
    chosen->estimate = error * pow(chosen->trial.run.step / step_s, chosen->order);
    return chosen->pilots.solver->open(&chosen->trial, &chosen->state, err);
}

static bool chosen_prepare(void *state, SolverPulse pulse, Err *err)
{
    Chosen *chosen = state;
    chosen->pilots.pulse = pulse;
    return choose_step(chosen, err);
}

static bool chosen_step(void *state, double stop_s, Err *err)
{
    Chosen *chosen = state;
    // trials come with the first step where they have not been made
    if (chosen->state == NULL && !choose_step(chosen, err)) {
        return false;
    }
    return chosen->pilots.solver->step(chosen->state, stop_s, err);
}

static StepRecord chosen_record(const void *state)
{
    const Chosen *chosen = state;
    return chosen->pilots.solver->record(chosen->state);
}

static void chosen_observe(const void *state, double time_s, Sample *sample)
{
    const Chosen *chosen = state;
    chosen->pilots.solver->observe(chosen->state, time_s, sample);
}

static SolverModel chosen_model(const void *state)
{
    const Chosen *chosen = state;
    SolverModel model = {.step_s = chosen->trial.run.step};
    if (chosen->state != NULL) {
        model = chosen->pilots.solver->model(chosen->state);
    }
    model.steps += chosen->pilots.steps;
    model.evaluations += chosen->pilots.evaluations;
    model.error_estimate = chosen->estimate;
    model.estimate_s = chosen->window_s;
    const size_t length = strlen(model.label);
    snprintf(model.label + length, sizeof model.label - length, ", error %.3g wanted",
             chosen->scenario->run.tolerance);
    return model;
}

const Solver STEPPING_CHOSEN = {
    .name = "chosen",
    .summary = "the step is chosen for the error that is wanted",
    .open = chosen_open,
    .prepare = chosen_prepare,
    .step = chosen_step,
    .record = chosen_record,
    .observe = chosen_observe,
    .model = chosen_model,
    .close = chosen_close,
};

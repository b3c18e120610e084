// Which step gives the error that the user asks for?
//
// No error is extrapolated: trials at falling steps are held against the truth at every sample, and
// the first that holds the tolerance up to the horizon is the run. See docs/stepping.md.
//
// The work of all trials is bounded by N world steps. A trial of step h costs c T / h, c known from
// the ones before; it is made only where as much is left afterwards, so that a run of that step can
// always be had whole. The last trial is as fine as what is left allows, and is not given up: it is
// the result, up to where it held.
#include "measure/chosen_run.h"

#include "base/clock.h"
#include "measure/step_choice.h"
#include "measure/trial.h"
#include "model/lock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// errors below this multiple of the reference's uncertainty are dominated by it
static const double TRUTH_SHARE = 0.1;

// world steps per step, before a trial has shown it: a gear of 2
static const double COST_AT_FIRST = 2.0;

// trials that fail at the same time, within a share of the run
enum { FAILURES_ALIKE = 9 };
static const double ONE_PLACE = 0.01;

// a step this near to that of a good trial is not tried instead
static const double NEAR_STEP = 1.2;

typedef struct Chosen {
    const Scenario *scenario;
    const Truth *truth;
    const RunProbe *probe;
    ChosenWatch watch;
    StepChoice choice;
    double started_s; // by the clock
    TrialWindow window;
    double cost; // world steps to a step
    size_t trials;
    size_t steps; // of all trials so far
    size_t evaluations;
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
static Trajectory *fail(const Chosen *chosen, const char *message)
{
    Trajectory *none = trajectory_create(chosen->scenario, OPTIONS_BACKENDS[BACKEND_ODE]);
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

// What watches a run goes by the time of all.
static RunWatch watch_of(Chosen *chosen)
{
    return (RunWatch){chosen->watch.run.progress != NULL ? pass_progress : NULL, chosen};
}

// Reports what begins.
static RunWatch begin(Chosen *chosen, size_t trial, double step_s)
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
    if (!(truth->trajectory->times[1] <= chosen->window.until_s)) {
        snprintf(message, size,
                 "no step can be chosen, because the motion cannot be predicted up to the first "
                 "sample, %.4g ms; take more samples, or give run.step",
                 1e3 * truth->trajectory->times[1]);
        return true;
    }
    return false;
}

// What the trial was made for, and what it cost, is known.
static void count(Chosen *chosen, const Trial *trial)
{
    const Trajectory *run = trial->run;
    chosen->steps += run->steps;
    chosen->evaluations += run->evaluations;
    chosen->wall_s += run->wall_s;
    const bool is_failed = !run->is_complete && !trial->is_given_up;
    // where one of several mechanisms fails, it may be far ahead of what all have reached
    if (!is_failed && run->duration_s > 0.0) {
        // what a short trial costs need not be what the rest of the run would have
        chosen->cost = fmax(chosen->cost, (double)run->steps * trial->step_s / run->duration_s);
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
    const size_t length = strlen(run->label);
    snprintf(run->label + length, sizeof run->label - length, ", error %.3g wanted",
             chosen->scenario->run.tolerance);
    return run;
}

static Trial make_trial(Chosen *chosen, double step_s, bool is_last)
{
    const double tolerance = chosen->scenario->run.tolerance;
    const Scenario scenario = step_choice_scenario(&chosen->choice, step_s);
    const TrialRule rule = {
        .truth = chosen->truth,
        .window = chosen->window,
        .tolerance = tolerance,
        .is_last = is_last,
        .is_smooth = chosen->choice.is_smooth,
    };
    const Trial trial =
        trial_make(&scenario, &rule, begin(chosen, ++chosen->trials, step_s), chosen->probe);
    count(chosen, &trial);
    return trial;
}

// World steps of a whole run of that step.
static double cost_of(const Chosen *chosen, double step_s)
{
    return chosen->cost * scenario_duration(chosen->scenario) / step_s;
}

static double steps_left(const Chosen *chosen)
{
    const size_t most = chosen->scenario->run.most_steps;
    return most > chosen->steps ? (double)(most - chosen->steps) : 1.0;
}

// The step of the last trial: as fine as can be had, unless that is no finer than the best known.
static double last_step(const Chosen *chosen, double wanted_s)
{
    const double finest_s = chosen->cost * scenario_duration(chosen->scenario) / steps_left(chosen);
    const double step_s = fmax(wanted_s, finest_s);
    const bool is_near = chosen->best_step_s > 0.0 && step_s * NEAR_STEP >= chosen->best_step_s;
    return is_near ? chosen->best_step_s : step_s;
}

// The result where no further trial is worth it, or why there is none.
static Trajectory *end_trials(const Chosen *chosen, Trial *trial)
{
    char message[ERR_TEXT_SIZE];
    if (trial->holds || (trial->run->is_complete && trial->held_s > 0.0)) {
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
    Trajectory *none = fail(chosen, message);
    trial_finish(trial);
    return none;
}

static Trajectory *choose(Chosen *chosen)
{
    const double duration_s = scenario_duration(chosen->scenario);
    double step_s = chosen->choice.first_step_s;
    for (;;) {
        const bool is_last = 2.0 * cost_of(chosen, step_s) > steps_left(chosen);
        step_s = is_last ? last_step(chosen, step_s) : step_s;
        Trial trial = make_trial(chosen, step_s, is_last);
        if (trial.holds || is_last || chosen->failures == FAILURES_ALIKE) {
            return end_trials(chosen, &trial);
        }
        step_s = chosen->choice.is_smooth && trial.run->is_complete
                     ? step_choice_by_order(&chosen->choice, step_s,
                                            trial.worst / chosen->scenario->run.tolerance)
                 : trial.is_given_up ? step_choice_finer(step_s, trial.held_s / duration_s)
                                     : step_choice_after_failure(step_s);
        trial_finish(&trial);
    }
}

Trajectory *chosen_run_make(const Scenario *scenario, const Truth *truth, ChosenWatch watch,
                            const RunProbe *probe)
{
    Chosen chosen = {
        .scenario = scenario,
        .truth = truth,
        .probe = probe,
        .watch = watch,
        .choice = step_choice_begin(scenario),
        .started_s = clock_now_s(),
        .cost = COST_AT_FIRST,
    };
    Truth own = {.trajectory = NULL};
    if (truth == NULL) {
        own = truth_make(scenario, begin(&chosen, 0, 0.0));
        chosen.truth = &own;
    }
    if (chosen.truth->trajectory->is_complete) {
        chosen.window = trial_window(scenario, chosen.truth, TRUTH_SHARE * scenario->run.tolerance,
                                     watch_of(&chosen));
    }
    char message[ERR_TEXT_SIZE];
    Trajectory *run =
        lacks_truth(&chosen, message, sizeof message) ? fail(&chosen, message) : choose(&chosen);
    truth_finish(&own);
    return run;
}

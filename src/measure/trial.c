// Does a run of this step hold the tolerance, and up to when?
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
#include "measure/trial.h"

#include "base/zeroed.h"

#include "model/distance.h"
#include "run/registry.h"

#include <math.h>

// a reference is rarely off by more than it says, and by three times that hardly ever
static const double TRUTH_MARGIN = 3.0;

// of the other run's tolerance to the truth's
static const double OTHER = 1e1;

typedef struct Watcher {
    const TrialRule *rule;
    DistanceMeasure measure; // of the truth
    Trial *trial;
    bool is_over; // the tolerance was exceeded
} Watcher;

static bool look(const Trajectory *trajectory, size_t sample, void *context, Err *err)
{
    Watcher *watcher = context;
    const TrialRule *rule = watcher->rule;
    const Trajectory *truth = rule->truth->trajectory;
    Trial *trial = watcher->trial;
    const double time_s = truth->times[sample];
    const bool is_behind = time_s > rule->window.until_s;
    const bool is_of_interest =
        !is_behind || (rule->window.is_uncertain && time_s <= rule->window.horizon_s);
    if (!is_of_interest || (watcher->is_over && !rule->is_smooth)) {
        return true;
    }
    const double apart = distance_apart(&watcher->measure, distance_motion_at(trajectory, sample),
                                        distance_motion_at(truth, sample), NULL);
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
    const bool runs_on = rule->is_last || rule->is_smooth;
    trial->is_given_up = !runs_on;
    return runs_on || err_set(err, ERR_SOLVER, "the step is too coarse");
}

Trial trial_make(const Scenario *scenario, const TrialRule *rule, RunWatch watch,
                 const RunProbe *probe)
{
    Trial trial = {.step_s = scenario->run.step};
    Watcher watcher = {
        .rule = rule,
        .trial = &trial,
        .measure = distance_measure(rule->truth->trajectory),
    };
    const RunGuard guard = {look, &watcher};
    trial.run = run_guarded(scenario, registry_solver(BACKEND_ODE), watch, probe, &guard);
    trial.holds = trial.run->is_complete && !watcher.is_over;
    distance_finish(&watcher.measure);
    return trial;
}

void trial_finish(Trial *trial)
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

TrialWindow trial_window(const Scenario *scenario, const Truth *truth, double most, RunWatch watch)
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
    Scenario other = *scenario;
    // looser, or tighter where no run is as loose
    const double own = options_reference_tolerance(&scenario->reference);
    other.reference.tolerance = own < OPTIONS_REFERENCE_LOOSEST / OTHER ? OTHER * own : own / OTHER;
    Trajectory *run = run_motion(&other, registry_solver(BACKEND_REFERENCE), watch);
    const TrialWindow window = run->is_complete
                                   ? shorten(truth->trajectory, run, truth->growth, whole, most)
                                   : (TrialWindow){.is_uncertain = true};
    trajectory_destroy(run);
    return window;
}

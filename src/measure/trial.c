// Does a run of this step hold the tolerance, and up to when?
//
// The error at a sample is that of model/distance.c against the truth's, and with it the truth's
// own uncertainty with a margin, so that what is held is an upper bound.
//
// The truth's uncertainty U belongs to its horizon T and was less before. How it grew shows in the
// distance to a run of the reference at another tolerance, d(t), the largest so far:
//     U(t) = U d(t) / d(T)
#include "measure/trial.h"

#include "base/zeroed.h"

#include "model/distance.h"
#include "run/registry.h"

#include <math.h>

// a reference is rarely off by more than it says, and by three times that hardly ever
static const double TRUTH_MARGIN = 3.0;

// of the other run's tolerance to the truth's
static const double OTHER = 1e2;

typedef struct Watcher {
    const TrialRule *rule;
    DistanceScale *scales; // owned
    Trial *trial;
    bool is_over; // the tolerance was exceeded
} Watcher;

static bool look(const Trajectory *trajectory, size_t sample, void *context, Err *err)
{
    Watcher *watcher = context;
    const TrialRule *rule = watcher->rule;
    const Truth *truth = rule->truth;
    Trial *trial = watcher->trial;
    const double time_s = truth->trajectory->times[sample];
    if (time_s > rule->window.until_s || (watcher->is_over && !rule->is_smooth)) {
        return true;
    }
    const double bound = distance_at(trajectory, truth->trajectory, sample, watcher->scales) +
                         TRUTH_MARGIN * rule->window.uncertainty;
    trial->worst = fmax(trial->worst, bound);
    if (watcher->is_over) {
        return true;
    }
    if (bound <= rule->tolerance) {
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
        .scales = zeroed(scenario->linkage.body_count, sizeof *watcher.scales),
    };
    distance_scales(rule->truth->trajectory, watcher.scales);
    const RunGuard guard = {look, &watcher};
    trial.run = run_guarded(scenario, registry_solver(BACKEND_ODE), watch, probe, &guard);
    trial.holds = trial.run->is_complete && !watcher.is_over;
    free(watcher.scales);
    return trial;
}

void trial_finish(Trial *trial)
{
    trajectory_destroy(trial->run);
    trial->run = NULL;
}

static TrialWindow shorten(const Trajectory *truth, const Trajectory *other, TrialWindow whole,
                           double most)
{
    DistanceScale *scales = zeroed(truth->body_count, sizeof *scales);
    distance_scales(truth, scales);
    double largest = 0.0;
    for (size_t k = 0; k < truth->sample_count && truth->times[k] <= whole.until_s; k++) {
        largest = fmax(largest, distance_at(other, truth, k, scales));
    }
    TrialWindow window = {.until_s = 0.0};
    double so_far = 0.0;
    for (size_t k = 0; largest > 0.0 && k < truth->sample_count; k++) {
        so_far = fmax(so_far, distance_at(other, truth, k, scales));
        const double uncertainty = whole.uncertainty * so_far / largest;
        window.is_uncertain = truth->times[k] <= whole.until_s && !(uncertainty <= most);
        if (truth->times[k] > whole.until_s || window.is_uncertain) {
            break;
        }
        window = (TrialWindow){.until_s = truth->times[k], .uncertainty = uncertainty};
    }
    free(scales);
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
    Trajectory *run = run_scenario(&other, registry_solver(BACKEND_REFERENCE), watch);
    const TrialWindow window = run->is_complete ? shorten(truth->trajectory, run, whole, most)
                                                : (TrialWindow){.is_uncertain = true};
    trajectory_destroy(run);
    return window;
}

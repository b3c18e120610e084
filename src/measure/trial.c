// Does a run of this step hold the tolerance, and up to when?
//
// The error at a sample is that of model/distance.c against the truth's, and with it the truth's
// own uncertainty, widely meant: what is held is an upper bound.
#include "measure/trial.h"

#include "model/distance.h"
#include "run/registry.h"

#include <math.h>

// a reference is rarely off by more than it says, and by three times that hardly ever
static const double TRUTH_MARGIN = 3.0;

typedef struct Watcher {
    const TrialRule *rule;
    DistanceScale scales[LINKAGE_BODY_MAX];
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
    if (watcher->is_over || time_s > rule->window.until_s) {
        return true;
    }
    const double bound = distance_at(trajectory, truth->trajectory, sample, watcher->scales) +
                         TRUTH_MARGIN * rule->window.uncertainty;
    if (bound <= rule->tolerance) {
        trial->held_s = time_s;
        trial->held_error = fmax(trial->held_error, bound);
        return true;
    }
    watcher->is_over = true;
    trial->error = bound;
    trial->is_given_up = !rule->is_last;
    return rule->is_last || err_set(err, ERR_SOLVER, "the step is too coarse");
}

Trial trial_make(const Scenario *scenario, const TrialRule *rule, RunWatch watch,
                 const RunProbe *probe)
{
    Trial trial = {.step_s = scenario->run.step};
    Watcher watcher = {.rule = rule, .trial = &trial};
    distance_scales(rule->truth->trajectory, watcher.scales);
    const RunGuard guard = {look, &watcher};
    trial.run = run_guarded(scenario, registry_solver(BACKEND_ODE), watch, probe, &guard);
    trial.holds = trial.run->is_complete && !watcher.is_over;
    return trial;
}

void trial_finish(Trial *trial)
{
    trajectory_destroy(trial->run);
    trial->run = NULL;
}

// Does a run of this step hold the tolerance, and up to when?
//
// The error at a sample is that of model/distance.c against the truth's, and with it the truth's
// own uncertainty: what is held is an upper bound.
#include "compare/trial.h"

#include "model/distance.h"
#include "run/registry.h"

#include <math.h>

typedef struct Watcher {
    const TrialRule *rule;
    DistanceScale scales[LINKAGE_BODY_MAX];
    Trial *trial;
    bool is_over; // the tolerance was exceeded
} Watcher;

static bool look(const Trajectory *trajectory, size_t sample, size_t steps, void *context, Err *err)
{
    Watcher *watcher = context;
    const TrialRule *rule = watcher->rule;
    Trial *trial = watcher->trial;
    const double time_s = rule->truth->trajectory->times[sample];
    if (time_s > rule->window_s) {
        return true;
    }
    const double bound = distance_at(trajectory, rule->truth->trajectory, sample, watcher->scales) +
                         rule->truth->uncertainty;
    // a number that is not finite is no error to go on with
    trial->error = bound <= trial->error ? trial->error : bound;
    trial->reached_s = time_s;
    watcher->is_over = watcher->is_over || !(bound <= rule->tolerance);
    if (!watcher->is_over) {
        trial->held_s = time_s;
        trial->held_error = trial->error;
    }
    trial->is_given_up =
        watcher->is_over && (!(bound <= rule->give_up) || steps > rule->most_steps);
    return !trial->is_given_up || err_set(err, ERR_SOLVER, "the step is too coarse");
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

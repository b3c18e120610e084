// Which solution are errors measured against, how sure is it, and how far does it hold?
//
// Uncertainty: the distance to a run at a hundredth of the tolerance. Horizon: a twin whose start
// is 1e-10 beside moves away; past the time at which that distance has grown 1e5 times, two
// solutions that are right to 1e-10 have only five digits in common, and an engine's none.
#include "compare/truth.h"

#include "compare/error.h"
#include "model/perturb.h"
#include "run/registry.h"

#include <assert.h>
#include <stdlib.h>

static const double TIGHTER = 1e-2;       // the second run's tolerance over the first's
static const double PERTURBATION = 1e-10; // of the twin's start
static const double GROWTH_MAX = 1e5;     // of the twin's distance, up to the horizon

static Trajectory *run(const Scenario *scenario, BackendKind backend, RunWatch watch)
{
    return run_scenario(scenario, registry_solver(backend), watch);
}

// The horizon is the last sample before the twin's distance passes the limit.
static void find_horizon(const Trajectory *trajectory, const Trajectory *twin, Truth *truth)
{
    double *distance = calloc(trajectory->sample_count, sizeof *distance);
    assert(distance != NULL);
    if (error_series(twin, trajectory, distance)) {
        for (size_t k = 0; k < trajectory->sample_count && !truth->is_limited; k++) {
            truth->is_limited = !(distance[k] <= GROWTH_MAX * PERTURBATION);
            if (!truth->is_limited) {
                truth->horizon_s = trajectory->times[k];
                truth->growth = fmax(truth->growth, distance[k] / PERTURBATION);
            }
        }
    }
    free(distance);
}

static void certify_ideal(const Scenario *scenario, RunWatch watch, Truth *truth)
{
    truth->trajectory = run(scenario, BACKEND_ANALYTIC, watch);
    truth->horizon_s = scenario_duration(scenario);
    Trajectory *second = run(scenario, BACKEND_REFERENCE, watch);
    const TrajectoryError error = error_against(second, truth->trajectory, truth->horizon_s);
    truth->uncertainty = error.is_known ? error.omega_max : INFINITY;
    trajectory_destroy(second);
}

Truth truth_make(const Scenario *scenario, RunWatch watch)
{
    Truth truth = {.growth = 1.0};
    if (scenario->has_fourbar && !scenario_has_clearance(scenario)) {
        certify_ideal(scenario, watch, &truth);
        return truth;
    }
    Scenario tight = *scenario;
    tight.reference.tolerance *= TIGHTER;
    Scenario beside = tight;
    perturb_start(&beside, PERTURBATION, 1);
    truth.trajectory = run(scenario, BACKEND_REFERENCE, watch);
    truth.horizon_s = scenario_duration(scenario);
    truth.uncertainty = INFINITY;
    if (!truth.trajectory->is_complete) {
        return truth;
    }
    // what cannot be certified holds nowhere
    truth.horizon_s = 0.0;
    truth.is_limited = true;
    Trajectory *tighter = run(&tight, BACKEND_REFERENCE, watch);
    Trajectory *twin = run(&beside, BACKEND_REFERENCE, watch);
    if (tighter->is_complete && twin->is_complete) {
        truth.is_limited = false;
        find_horizon(tighter, twin, &truth);
        truth.uncertainty =
            error_against(truth.trajectory, tighter, truth.horizon_s).omega_max_in_horizon;
    }
    trajectory_destroy(tighter);
    trajectory_destroy(twin);
    return truth;
}

void truth_finish(Truth *truth)
{
    trajectory_destroy(truth->trajectory);
    *truth = (Truth){.trajectory = NULL};
}

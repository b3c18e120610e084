// Which solution are errors measured against, how sure is it, and how far does it hold?
//
// Uncertainty: the distance to a run at a hundredth of the tolerance. Horizon: starts 1e-10 beside
// move away, the fastest of all of them (model/growth.c); where that has grown 1e5 times, two
// solutions that are right to 1e-10 have only five digits in common, and an engine's none. The same
// holds where the second run is that far away. Both are watched on a grid of at least a thousand
// samples, for the case's own samples may be few.
#include "compare/truth.h"

#include "base/clock.h"
#include "compare/error.h"
#include "model/distance.h"
#include "model/growth.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

static const double TIGHTER = 1e-2;   // the second run's tolerance over the first's
static const double TIGHTEST = 1e-14; // below it rounding does not let steps follow

static Trajectory *run(const Scenario *scenario, BackendKind backend, RunWatch watch)
{
    return run_scenario(scenario, registry_solver(backend), watch);
}

// Shortens the horizon to where another run is further away than the limit, and returns the largest
// distance up to there. A run that cannot be compared leaves no horizon.
static double shorten_horizon(const Trajectory *trajectory, const Trajectory *other, Truth *truth)
{
    const size_t count = trajectory->sample_count;
    double *distance = calloc(count, sizeof *distance);
    assert(distance != NULL);
    double largest = 0.0;
    double reached = 0.0;
    size_t k = 0;
    if (error_series(other, trajectory, distance)) {
        while (k < count && distance[k] <= DISTANCE_GROWTH * DISTANCE_PERTURBATION &&
               trajectory->times[k] <= truth->horizon_s) {
            largest = fmax(largest, distance[k]);
            reached = trajectory->times[k++];
        }
    }
    truth->is_limited =
        truth->is_limited || (k < count && trajectory->times[k] <= truth->horizon_s);
    truth->horizon_s = fmin(truth->horizon_s, reached);
    free(distance);
    return largest;
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

// A complete run, or the reason in the truth's message.
static Trajectory *run_for(const Scenario *scenario, RunWatch watch, Truth *truth)
{
    Trajectory *trajectory = run(scenario, BACKEND_REFERENCE, watch);
    if (!trajectory->is_complete && truth->message[0] == '\0') {
        snprintf(truth->message, sizeof truth->message, "%s", trajectory->message);
    }
    return trajectory;
}

// Who watches the perturbed runs, which go on side by side.
typedef struct Beats {
    RunWatch watch;
    double started_s;
} Beats;

static void beat(void *context)
{
    const Beats *beats = context;
    beats->watch.progress(0.0, clock_now_s() - beats->started_s, beats->watch.context);
}

// Shortens the horizon to where the fastest of all perturbations has grown too much.
static void follow_growth(const Scenario *scenario, const Trajectory *beside, RunWatch watch,
                          Truth *truth)
{
    Beats beats = {watch, clock_now_s()};
    DistanceScale scales[LINKAGE_BODY_MAX];
    PerturbBasis *basis = malloc(sizeof *basis);
    assert(basis != NULL);
    distance_scales(beside, scales);
    perturb_basis(scenario, scales, basis);
    const Growth growth = growth_find(&(GrowthWork){
        .solver = registry_solver(BACKEND_REFERENCE),
        .scenario = scenario,
        .beside = beside,
        .scales = scales,
        .basis = basis,
        .size = DISTANCE_PERTURBATION,
        .most = DISTANCE_GROWTH,
        .until_s = truth->horizon_s,
        .pulse = {watch.progress != NULL ? beat : NULL, &beats},
    });
    truth->growth = growth.largest;
    truth->is_limited = truth->is_limited || growth.is_limited;
    truth->horizon_s = growth.until_s;
    if (growth.is_failed) {
        snprintf(truth->message, sizeof truth->message, "%s", growth.failure.text);
    }
    free(basis);
}

// Compares the reference on the fine grid with a second run of another tolerance, and that with
// perturbed runs.
static void certify(const Scenario *fine, const Scenario *other, RunWatch watch, Truth *truth)
{
    // the first run is there already where the case's own samples are fine enough
    const bool is_there = scenario_sample_count(fine) == truth->trajectory->sample_count;
    Trajectory *first = is_there ? truth->trajectory : run_for(fine, watch, truth);
    Trajectory *second = run_for(other, watch, truth);
    truth->is_limited = false;
    truth->horizon_s = scenario_duration(fine);
    shorten_horizon(second, first, truth);
    if (truth->message[0] == '\0') {
        follow_growth(other, second, watch, truth);
    }
    truth->uncertainty = shorten_horizon(second, first, truth);
    if (truth->message[0] != '\0') {
        truth->is_limited = true;
        truth->horizon_s = 0.0;
        truth->uncertainty = INFINITY;
    }
    trajectory_destroy(second);
    if (!is_there) {
        trajectory_destroy(first);
    }
}

BackendKind truth_backend(const Scenario *scenario)
{
    return scenario->has_fourbar && !scenario_has_clearance(scenario) ? BACKEND_ANALYTIC
                                                                      : BACKEND_REFERENCE;
}

Truth truth_make(const Scenario *scenario, RunWatch watch)
{
    Truth truth = {.growth = 1.0};
    if (truth_backend(scenario) == BACKEND_ANALYTIC) {
        certify_ideal(scenario, watch, &truth);
        return truth;
    }
    truth.horizon_s = 0.0;
    truth.is_limited = true;
    truth.uncertainty = INFINITY;
    truth.trajectory = tracer_run(scenario, registry_solver(BACKEND_REFERENCE), watch);
    if (!truth.trajectory->is_complete) {
        return truth;
    }
    // the second run is tighter, unless the first is as tight as can be
    const Scenario fine = distance_grid(scenario);
    Scenario other = fine;
    const double tolerance = scenario->reference.tolerance;
    other.reference.tolerance = fmax(TIGHTEST, TIGHTER * tolerance);
    if (other.reference.tolerance >= tolerance) {
        other.reference.tolerance = tolerance / TIGHTER;
    }
    certify(&fine, &other, watch, &truth);
    return truth;
}

void truth_finish(Truth *truth)
{
    trajectory_destroy(truth->trajectory);
    *truth = (Truth){.trajectory = NULL};
}

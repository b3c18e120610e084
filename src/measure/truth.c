// Which solution are errors measured against, how sure is it, and how far does it hold?
//
// Uncertainty: two more runs say what the first one's error may be. The second has a thirtieth of
// its tolerance. The third has a tenth of it, other steps therefore, and inputs rounded once more:
// where rounding rules, which no tolerance shows, these two differ from one another as much as the
// first may be off. With d the largest distances up to the horizon,
//     uncertainty = max(d(1, 2), d(1, 3)) + d(2, 3), at least rounding times growth.
// Were all three errors draws of one normal distribution, the first would be above three times that
// in one case of 200.
// Horizon: starts 1e-10 beside move away, the fastest of all of them (model/growth.c); where that
// has grown 1e5 times, two solutions that are right to 1e-10 have only five digits in common, and
// an engine's none. The same holds where the second or third run is that far away. All are watched
// on a grid of at least a thousand samples, for the case's own samples may be few.
#include "measure/truth.h"

#include "base/clock.h"
#include "measure/error.h"
#include "model/distance.h"
#include "model/growth.h"
#include "model/shake.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

// tolerances of the second and third run over the first's
static const double SECOND = 1.0 / 30.0;
static const double THIRD = 1.0 / 10.0;

enum { THIRD_SEED = 1 }; // of its inputs' rounding

// 1: no speed is held to less than this share of itself
static const double ROUNDING = 0x1p-53;

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
    truth->uncertainty = error.is_known ? error.omega_max + ROUNDING : INFINITY;
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

// The scenario with another tolerance of the reference.
static Scenario with_tolerance(const Scenario *scenario, double factor)
{
    Scenario other = *scenario;
    other.reference.tolerance *= factor;
    return other;
}

// Compares the reference on the fine grid with a second and a third run, and the second with
// perturbed ones.
static void certify(const Scenario *fine, RunWatch watch, Truth *truth)
{
    // the first run is there already where the case's own samples are fine enough
    const bool is_there = scenario_sample_count(fine) == truth->trajectory->sample_count;
    const Scenario tight = with_tolerance(fine, SECOND);
    const Scenario third_one = with_tolerance(fine, THIRD);
    Scenario shaken = scenario_copy(&third_one);
    shake_inputs(&shaken, THIRD_SEED);
    Trajectory *first = is_there ? truth->trajectory : run_for(fine, watch, truth);
    Trajectory *second = run_for(&tight, watch, truth);
    Trajectory *third = run_for(&shaken, watch, truth);
    truth->is_limited = false;
    truth->horizon_s = scenario_duration(fine);
    shorten_horizon(second, first, truth);
    shorten_horizon(second, third, truth);
    if (truth->message[0] == '\0') {
        follow_growth(&tight, second, watch, truth);
    }
    // now that the horizon is known
    const double to_second = shorten_horizon(second, first, truth);
    const double to_third = shorten_horizon(first, third, truth);
    const double between = shorten_horizon(second, third, truth);
    truth->uncertainty = fmax(fmax(to_second, to_third) + between, ROUNDING * truth->growth);
    if (truth->message[0] != '\0') {
        truth->is_limited = true;
        truth->horizon_s = 0.0;
        truth->uncertainty = INFINITY;
    }
    trajectory_destroy(third);
    trajectory_destroy(second);
    scenario_free(&shaken);
    if (!is_there) {
        trajectory_destroy(first);
    }
}

BackendKind truth_backend(const Scenario *scenario)
{
    return scenario_has_closed_form(scenario) && !scenario_has_clearance(scenario)
               ? BACKEND_ANALYTIC
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
    const Scenario fine = distance_grid(scenario);
    certify(&fine, watch, &truth);
    return truth;
}

void truth_finish(Truth *truth)
{
    trajectory_destroy(truth->trajectory);
    *truth = (Truth){.trajectory = NULL};
}

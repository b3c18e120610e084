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
#include "base/side_by_side.h"
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

// Tolerance of the perturbed runs over the perturbation: growth is then wrong by some hundredths.
static const double PERTURBED_SHARE = 1e-3;

enum { THIRD_SEED = 1 }; // of its inputs' rounding

// 1: no speed is held to less than this share of itself
static const double ROUNDING = 0x1p-53;

static Trajectory *run(const Scenario *scenario, BackendKind backend, RunWatch watch)
{
    return run_scenario(scenario, registry_solver(backend), watch);
}

// How far two runs are apart at each sample.
typedef struct Apart {
    size_t count; // 0 where they cannot be compared
    const double *times;
    double *distance; // owned
} Apart;

static Apart apart_of(const Trajectory *trajectory, const Trajectory *other)
{
    Apart apart = {.times = trajectory->times};
    apart.distance = calloc(trajectory->sample_count + 1, sizeof *apart.distance);
    assert(apart.distance != NULL);
    const bool is_known = error_series(other, trajectory, apart.distance);
    apart.count = is_known ? trajectory->sample_count : 0;
    return apart;
}

// Shortens the horizon to where two runs are further apart than the limit, and returns the largest
// distance up to there. Runs that cannot be compared leave no horizon.
static double shorten_horizon(const Apart *apart, Truth *truth)
{
    const size_t count = apart->count;
    double largest = 0.0;
    double reached = 0.0;
    size_t k = 0;
    while (k < count && apart->distance[k] <= DISTANCE_GROWTH * DISTANCE_PERTURBATION &&
           apart->times[k] <= truth->horizon_s) {
        largest = fmax(largest, apart->distance[k]);
        reached = apart->times[k++];
    }
    truth->is_limited =
        truth->is_limited || count == 0 || (k < count && apart->times[k] <= truth->horizon_s);
    truth->horizon_s = fmin(truth->horizon_s, reached);
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

// Keeps the first reason why a run is not complete.
static void note_failure(const Trajectory *trajectory, Truth *truth)
{
    if (!trajectory->is_complete && truth->message[0] == '\0') {
        snprintf(truth->message, sizeof truth->message, "%s", trajectory->message);
    }
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
                          size_t threads, Truth *truth)
{
    Beats beats = {watch, clock_now_s()};
    if (scenario->linkage.body_count > PERTURB_BODY_MAX) {
        return; // the other two runs alone say how far it can be predicted
    }
    DistanceScale scales[PERTURB_BODY_MAX];
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
        .threads = threads,
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
static Scenario with_tolerance(const Scenario *scenario, double tolerance)
{
    Scenario other = *scenario;
    other.reference.tolerance = tolerance;
    return other;
}

// The runs that a truth is made of, at the same time where there are processors.
enum { RUN_FIRST, RUN_SECOND, RUN_THIRD, RUN_FINE, RUN_COUNT };

typedef struct Runs {
    Scenario scenarios[RUN_COUNT]; // the third owns its linkage, the others share the caller's
    Trajectory *trajectories[RUN_COUNT]; // owned, but where two are one
    RunWatch watch;
} Runs;

static void make_run(size_t index, bool is_callers, void *context)
{
    Runs *runs = context;
    const Scenario *scenario = &runs->scenarios[index];
    const RunWatch watch = is_callers ? runs->watch : (RunWatch){NULL, NULL};
    // spikes are those of the first alone
    runs->trajectories[index] =
        index == RUN_FIRST ? tracer_run(scenario, registry_solver(BACKEND_REFERENCE), watch)
                           : run(scenario, BACKEND_REFERENCE, watch);
}

// The first on the case's own samples; on the fine grid itself, where these are fine enough.
static void make_runs(const Scenario *scenario, size_t threads, Runs *runs)
{
    const double tolerance = scenario->reference.tolerance;
    const Scenario fine = distance_grid(scenario);
    runs->scenarios[RUN_FIRST] = *scenario;
    runs->scenarios[RUN_FINE] = fine;
    runs->scenarios[RUN_SECOND] = with_tolerance(&fine, SECOND * tolerance);
    const Scenario third = with_tolerance(&fine, THIRD * tolerance);
    runs->scenarios[RUN_THIRD] = scenario_copy(&third);
    shake_inputs(&runs->scenarios[RUN_THIRD], THIRD_SEED);
    const bool is_fine = scenario_sample_count(&fine) == scenario_sample_count(scenario);
    side_by_side_run(is_fine ? RUN_FINE : RUN_COUNT, threads, make_run, runs);
    if (is_fine) {
        runs->trajectories[RUN_FINE] = runs->trajectories[RUN_FIRST];
    }
}

// The tolerance of perturbed runs: theirs is the error of the distance to the second.
static double perturbed_tolerance(const Scenario *scenario)
{
    const double first = scenario->reference.tolerance;
    return fmin(first, fmax(SECOND * first, PERTURBED_SHARE * DISTANCE_PERTURBATION));
}

// Compares the first run on the fine grid with the second and third, and the second with perturbed
// ones.
static void certify(const Runs *runs, size_t threads, Truth *truth)
{
    const Scenario *fine = &runs->scenarios[RUN_FINE];
    const Trajectory *first = runs->trajectories[RUN_FINE];
    const Trajectory *second = runs->trajectories[RUN_SECOND];
    const Trajectory *third = runs->trajectories[RUN_THIRD];
    note_failure(first, truth);
    note_failure(second, truth);
    note_failure(third, truth);
    truth->is_limited = false;
    truth->horizon_s = scenario_duration(fine);
    const Apart from_second = apart_of(second, first);
    const Apart from_third = apart_of(first, third);
    const Apart between_both = apart_of(second, third);
    shorten_horizon(&from_second, truth);
    shorten_horizon(&between_both, truth);
    if (truth->message[0] == '\0') {
        const Scenario perturbed = with_tolerance(fine, perturbed_tolerance(fine));
        follow_growth(&perturbed, second, runs->watch, threads, truth);
    }
    // now that the horizon is known
    const double to_second = shorten_horizon(&from_second, truth);
    const double to_third = shorten_horizon(&from_third, truth);
    const double between = shorten_horizon(&between_both, truth);
    truth->uncertainty = fmax(fmax(to_second, to_third) + between, ROUNDING * truth->growth);
    if (truth->message[0] != '\0') {
        truth->is_limited = true;
        truth->horizon_s = 0.0;
        truth->uncertainty = INFINITY;
    }
    free(from_second.distance);
    free(from_third.distance);
    free(between_both.distance);
}

BackendKind truth_backend(const Scenario *scenario)
{
    return scenario_has_closed_form(scenario) && !scenario_has_clearance(scenario)
               ? BACKEND_ANALYTIC
               : BACKEND_REFERENCE;
}

static Truth certified(const Scenario *scenario, RunWatch watch, size_t threads)
{
    Truth truth = {.growth = 1.0, .horizon_s = 0.0, .is_limited = true, .uncertainty = INFINITY};
    Runs *runs = calloc(1, sizeof *runs);
    assert(runs != NULL);
    runs->watch = watch;
    make_runs(scenario, threads, runs);
    truth.trajectory = runs->trajectories[RUN_FIRST];
    if (truth.trajectory->is_complete) {
        certify(runs, threads, &truth);
    }
    for (size_t i = RUN_SECOND; i < RUN_COUNT; i++) {
        if (runs->trajectories[i] != truth.trajectory) {
            trajectory_destroy(runs->trajectories[i]);
        }
    }
    scenario_free(&runs->scenarios[RUN_THIRD]);
    free(runs);
    return truth;
}

Truth truth_make_on(const Scenario *scenario, RunWatch watch, size_t threads)
{
    Truth truth = {.growth = 1.0};
    if (truth_backend(scenario) == BACKEND_ANALYTIC) {
        certify_ideal(scenario, watch, &truth);
        return truth;
    }
    return certified(scenario, watch, threads);
}

Truth truth_make(const Scenario *scenario, RunWatch watch)
{
    return truth_make_on(scenario, watch, 1);
}

Truth truth_make_uncertified(const Scenario *scenario, RunWatch watch)
{
    Truth truth = {
        .uncertainty = INFINITY,
        .horizon_s = scenario_duration(scenario),
        .growth = 1.0,
        .is_uncertified = true,
        .message = "nobody asked for it",
    };
    truth.trajectory = tracer_run(scenario, registry_solver(truth_backend(scenario)), watch);
    return truth;
}

void truth_finish(Truth *truth)
{
    trajectory_destroy(truth->trajectory);
    *truth = (Truth){.trajectory = NULL};
}

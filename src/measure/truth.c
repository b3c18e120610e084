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
// Sizes: errors are relative to the largest rates at the case's own samples. Where these
// miss a spike that is less than on the grid, and the uncertainty, which stands beside errors, is
// therefore taken in it; the horizon, which samples must not move, in that of the grid.
#include "measure/truth.h"

#include "base/zeroed.h"
#include "measure/error.h"
#include "measure/truth_runs.h"
#include "model/distance.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <stdio.h>
#include <stdlib.h>

// 1: no speed is held to less than this share of itself
static const double ROUNDING = 0x1p-53;

static Trajectory *run(const Scenario *scenario, BackendKind backend, RunWatch watch)
{
    return run_scenario(scenario, registry_solver(backend), watch);
}

// How far two runs are apart at each sample of the grid.
typedef struct Apart {
    size_t count; // 0 where they cannot be compared
    const double *times;
    double *distance; // relative to sizes on the grid; owned, like the next
    double *stated;   // as errors are stated: relative to sizes at the case's own samples
} Apart;

// With sizes on the grid and at the case's own samples.
static Apart apart_of(const Trajectory *trajectory, const Trajectory *other,
                      const DistanceMeasure *on_grid, const DistanceMeasure *at_own)
{
    Apart apart = {.times = trajectory->times};
    apart.distance = zeroed(trajectory->sample_count + 1, sizeof *apart.distance);
    apart.stated = zeroed(trajectory->sample_count + 1, sizeof *apart.stated);
    const bool is_known = error_series(other, trajectory, on_grid, apart.distance) &&
                          error_series(other, trajectory, at_own, apart.stated);
    apart.count = is_known ? trajectory->sample_count : 0;
    return apart;
}

static void apart_finish(Apart *apart)
{
    free(apart->distance);
    free(apart->stated);
}

// Shortens the horizon to where two runs are further apart than the limit. Runs that cannot be
// compared leave none.
static void shorten_horizon(const Apart *apart, Truth *truth)
{
    const size_t count = apart->count;
    double reached = 0.0;
    size_t k = 0;
    while (k < count && apart->distance[k] <= DISTANCE_GROWTH * DISTANCE_PERTURBATION &&
           apart->times[k] <= truth->horizon_s) {
        reached = apart->times[k++];
    }
    truth->is_limited =
        truth->is_limited || count == 0 || (k < count && apart->times[k] <= truth->horizon_s);
    truth->horizon_s = fmin(truth->horizon_s, reached);
}

// The largest distance up to the horizon, as errors are stated.
static double largest_stated(const Apart *apart, const Truth *truth)
{
    double largest = 0.0;
    for (size_t k = 0; k < apart->count && apart->times[k] <= truth->horizon_s; k++) {
        // a number that is not finite is no small one
        largest = !(apart->stated[k] <= largest) ? apart->stated[k] : largest;
    }
    return largest;
}

// How many times a distance may be larger by sizes at the case's own samples than by the grid's.
static double ratio_of_sizes(const DistanceMeasure *on_grid, const DistanceMeasure *at_own)
{
    double largest = 1.0;
    for (size_t i = 0; i < at_own->count; i++) {
        largest = fmax(largest, on_grid->rates[i].scale / at_own->rates[i].scale);
    }
    return largest;
}

static void certify_ideal(const Scenario *scenario, RunWatch watch, Truth *truth)
{
    truth->trajectory = run(scenario, BACKEND_ANALYTIC, watch);
    truth->horizon_s = scenario_duration(scenario);
    Trajectory *second = run(scenario, BACKEND_REFERENCE, watch);
    const TrajectoryError error = error_against(second, truth->trajectory, truth->horizon_s);
    truth->uncertainty = error.is_known ? error.max + ROUNDING : INFINITY;
    trajectory_destroy(second);
}

// Keeps the first reason why a run is not complete.
static void note_failure(const Trajectory *trajectory, Truth *truth)
{
    if (!trajectory->is_complete && truth->message[0] == '\0') {
        snprintf(truth->message, sizeof truth->message, "%s", trajectory->message);
    }
}

// Shortens the horizon to where the fastest of all perturbations has grown too much. Of large
// mechanisms the other two runs alone say how far they can be predicted.
static void take_growth(TruthRuns *runs, Truth *truth)
{
    Growth growth;
    if (!truth_runs_growth(runs, truth->horizon_s, &growth)) {
        return;
    }
    truth->growth = growth.largest;
    truth->is_limited = truth->is_limited || growth.is_limited;
    truth->horizon_s = growth.until_s;
    if (growth.is_failed) {
        snprintf(truth->message, sizeof truth->message, "%s", growth.failure.text);
    }
}

// Compares the first run on the fine grid with the second and third, and the second with perturbed
// ones.
static void certify(TruthRuns *runs, Truth *truth)
{
    const Trajectory *first = truth_runs_fine(runs);
    const Trajectory *second = truth_runs_second(runs);
    const Trajectory *third = truth_runs_third(runs);
    note_failure(first, truth);
    note_failure(second, truth);
    note_failure(third, truth);
    truth->is_limited = false;
    truth->horizon_s = truth_runs_duration(runs);
    DistanceMeasure of_first = distance_measure(first);
    DistanceMeasure of_second = distance_measure(second);
    DistanceMeasure own = distance_measure(truth_runs_first(runs));
    Apart aparts[] = {
        apart_of(second, first, &of_second, &own), apart_of(first, third, &of_first, &own),
        apart_of(second, third, &of_second, &own), // of the other two
    };
    shorten_horizon(&aparts[0], truth);
    shorten_horizon(&aparts[2], truth);
    if (truth->message[0] == '\0') {
        take_growth(runs, truth);
    }
    // now that the horizon is known
    for (int i = 0; i < 3; i++) {
        shorten_horizon(&aparts[i], truth);
    }
    const double to_others =
        fmax(largest_stated(&aparts[0], truth), largest_stated(&aparts[1], truth));
    truth->uncertainty = fmax(to_others + largest_stated(&aparts[2], truth),
                              ROUNDING * truth->growth * ratio_of_sizes(&of_first, &own));
    if (truth->message[0] != '\0') {
        truth->is_limited = true;
        truth->horizon_s = 0.0;
        truth->uncertainty = INFINITY;
    }
    for (int i = 0; i < 3; i++) {
        apart_finish(&aparts[i]);
    }
    distance_finish(&of_first);
    distance_finish(&of_second);
    distance_finish(&own);
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
    TruthRuns *runs = truth_runs_make(scenario, watch, threads);
    if (truth_runs_first(runs)->is_complete) {
        certify(runs, &truth);
    }
    truth.trajectory = truth_runs_finish(runs);
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
        .message = "it was not requested",
    };
    truth.trajectory = tracer_run(scenario, registry_solver(truth_backend(scenario)), watch);
    return truth;
}

void truth_finish(Truth *truth)
{
    trajectory_destroy(truth->trajectory);
    *truth = (Truth){.trajectory = NULL};
}

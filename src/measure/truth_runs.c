// Which runs make a truth, and in which order?
//
// first, second -> third, perturbed runs beside the second. Whoever has nothing else to do goes on
// with a perturbed run up to the samples where all of them are looked at (model/growth.c).
#include "measure/truth_runs.h"

#include "base/clock.h"
#include "model/distance.h"
#include "model/shake.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <assert.h>
#include <stdlib.h>

// tolerances of the second and third run over the first's
static const double SECOND = 1.0 / 30.0;
static const double THIRD = 1.0 / 10.0;

// Tolerance of the perturbed runs over the perturbation: growth is then wrong by some hundredths.
static const double PERTURBED_SHARE = 1e-3;

enum { THIRD_SEED = 1 }; // of its inputs' rounding

enum { RUN_FIRST, RUN_SECOND, RUN_THIRD, RUN_FINE, RUN_COUNT };

// The perturbed runs, from when they begin.
typedef struct Perturbed {
    bool is_begun;
    Scenario scenario;
    DistanceMeasure measure;
    PerturbBasis basis;
    GrowthRuns *runs; // owned
    double started_s; // by the clock
} Perturbed;

struct TruthRuns {
    Scenario scenarios[RUN_COUNT]; // the third owns its linkage, the others share the caller's
    Trajectory *trajectories[RUN_COUNT]; // owned, but where two are one
    size_t count;
    size_t next;
    bool is_over[RUN_COUNT];
    RunWatch watch;
    Perturbed perturbed;
};

// The scenario with another tolerance of the reference.
static Scenario with_tolerance(const Scenario *scenario, double tolerance)
{
    Scenario other = *scenario;
    other.reference.tolerance = tolerance;
    return other;
}

// The tolerance of perturbed runs: theirs is the error of the distance to the second.
static double perturbed_tolerance(const Scenario *scenario)
{
    const double first = options_reference_tolerance(&scenario->reference);
    return fmin(first, fmax(SECOND * first, PERTURBED_SHARE * DISTANCE_PERTURBATION));
}

static void beat(void *context)
{
    const TruthRuns *runs = context;
    runs->watch.progress(0.0, clock_now_s() - runs->perturbed.started_s, runs->watch.context);
}

static void begin_perturbed(TruthRuns *runs)
{
    Perturbed *perturbed = &runs->perturbed;
    const Scenario *fine = &runs->scenarios[RUN_FINE];
    const Trajectory *second = runs->trajectories[RUN_SECOND];
    perturbed->is_begun = true;
    for (size_t i = 0; i < runs->count; i++) {
        if (runs->is_over[i] && !runs->trajectories[i]->is_complete) {
            return;
        }
    }
    if (fine->linkage.body_count > PERTURB_BODY_MAX) {
        return;
    }
    perturbed->scenario = with_tolerance(fine, perturbed_tolerance(fine));
    perturbed->started_s = clock_now_s();
    perturbed->measure = distance_measure(second);
    PerturbUnit units[PERTURB_BODY_MAX];
    perturb_units(second, units);
    perturb_basis(&perturbed->scenario, &perturbed->measure, units, &perturbed->basis);
    perturbed->runs = growth_begin(&(GrowthWork){
        .solver = registry_solver(BACKEND_REFERENCE),
        .scenario = &perturbed->scenario,
        .beside = second,
        .measure = &perturbed->measure,
        .basis = &perturbed->basis,
        .size = DISTANCE_PERTURBATION,
        .most = DISTANCE_GROWTH,
        .until_s = INFINITY,
        .pulse = {runs->watch.progress != NULL ? beat : NULL, runs},
    });
}

static SideBySideNext next_piece(size_t *index, void *context)
{
    TruthRuns *runs = context;
    if (runs->next < runs->count) {
        *index = runs->next++;
        return SIDE_BY_SIDE_PIECE;
    }
    if (!runs->is_over[RUN_SECOND]) {
        return SIDE_BY_SIDE_LATER;
    }
    if (!runs->perturbed.is_begun) {
        begin_perturbed(runs);
    }
    if (runs->perturbed.runs == NULL) {
        return SIDE_BY_SIDE_NONE;
    }
    const SideBySideNext next = growth_next(index, runs->perturbed.runs);
    *index += runs->count;
    return next;
}

static void make_run(TruthRuns *runs, size_t index, bool is_callers)
{
    const Scenario *scenario = &runs->scenarios[index];
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    const RunWatch watch = is_callers ? runs->watch : (RunWatch){NULL, NULL};
    // the others are there to be compared with
    runs->trajectories[index] = index == RUN_FIRST ? tracer_run(scenario, solver, watch)
                                                   : run_motion(scenario, solver, watch);
}

static void do_piece(size_t index, bool is_callers, void *context)
{
    TruthRuns *runs = context;
    if (index < runs->count) {
        make_run(runs, index, is_callers);
    } else {
        growth_walk(index - runs->count, is_callers, runs->perturbed.runs);
    }
}

static void end_piece(size_t index, void *context)
{
    TruthRuns *runs = context;
    if (index < runs->count) {
        runs->is_over[index] = true;
    } else {
        growth_walked(index - runs->count, runs->perturbed.runs);
    }
}

// The first on the case's own samples; on the fine grid itself, where these are fine enough.
TruthRuns *truth_runs_make(const Scenario *scenario, RunWatch watch, size_t threads)
{
    TruthRuns *runs = calloc(1, sizeof *runs);
    assert(runs != NULL);
    const double tolerance = options_reference_tolerance(&scenario->reference);
    const Scenario fine = distance_grid(scenario);
    runs->watch = watch;
    runs->scenarios[RUN_FIRST] = *scenario;
    runs->scenarios[RUN_FINE] = fine;
    runs->scenarios[RUN_SECOND] = with_tolerance(&fine, SECOND * tolerance);
    const Scenario third = with_tolerance(&fine, THIRD * tolerance);
    runs->scenarios[RUN_THIRD] = scenario_copy(&third);
    shake_inputs(&runs->scenarios[RUN_THIRD], THIRD_SEED);
    const bool is_fine = scenario_sample_count(&fine) == scenario_sample_count(scenario);
    runs->count = is_fine ? RUN_FINE : RUN_COUNT;
    const SideBySideTasks tasks = {
        // most mechanisms have two starts for each joint with play
        .most = runs->count + 2 * scenario->linkage.joint_count,
        .next = next_piece,
        .work = do_piece,
        .end = end_piece,
        .context = runs,
    };
    side_by_side_tasks(&tasks, threads);
    if (is_fine) {
        runs->trajectories[RUN_FINE] = runs->trajectories[RUN_FIRST];
    }
    return runs;
}

const Trajectory *truth_runs_first(const TruthRuns *runs)
{
    return runs->trajectories[RUN_FIRST];
}

const Trajectory *truth_runs_fine(const TruthRuns *runs)
{
    return runs->trajectories[RUN_FINE];
}

const Trajectory *truth_runs_second(const TruthRuns *runs)
{
    return runs->trajectories[RUN_SECOND];
}

const Trajectory *truth_runs_third(const TruthRuns *runs)
{
    return runs->trajectories[RUN_THIRD];
}

double truth_runs_duration(const TruthRuns *runs)
{
    return scenario_duration(&runs->scenarios[RUN_FINE]);
}

bool truth_runs_growth(TruthRuns *runs, double until_s, Growth *growth)
{
    if (runs->perturbed.runs == NULL) {
        return false;
    }
    *growth = growth_end(runs->perturbed.runs, until_s);
    runs->perturbed.runs = NULL;
    return true;
}

Trajectory *truth_runs_finish(TruthRuns *runs)
{
    Growth unused;
    truth_runs_growth(runs, 0.0, &unused);
    Trajectory *first = runs->trajectories[RUN_FIRST];
    for (size_t i = RUN_SECOND; i < RUN_COUNT; i++) {
        if (runs->trajectories[i] != first) {
            trajectory_destroy(runs->trajectories[i]);
        }
    }
    distance_finish(&runs->perturbed.measure);
    scenario_free(&runs->scenarios[RUN_THIRD]);
    free(runs);
    return first;
}

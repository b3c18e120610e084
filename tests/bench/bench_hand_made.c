// What does generality cost? The paper's case by a program made for it alone, and by this one.
//
// One revolution from the centred start, 3,600 samples. For each error of omega: processor time of
// the cheapest run that has no more, on a ladder of tolerances or steps, and in brackets its ratio
// to the program made by hand (tests/support/hand_paper.c). Medians over rounds in which all rungs
// of all ways take turns, in either order. Runs of the program find extremes and spikes, as `run`
// has them; of `step: auto` the tolerance is the error asked for, and its trials count.
#include "base/clock.h"
#include "base/sorted.h"
#include "casefile/casefile.h"
#include "hand_paper.h"
#include "measure/chosen_run.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 7, RUNG_MAX = 24, SAMPLES = 3601, FIRST_BODY = 1, PATH_SIZE = 1024 };

static const RunWatch NOBODY = {NULL, NULL};

static const double ERRORS[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-11};
enum { ERROR_COUNT = sizeof ERRORS / sizeof *ERRORS };

typedef struct Bench {
    const Scenario *scenario;
    Trajectory *best; // what errors are measured against
    Truth truth;      // what auto is held against
    HandPaperSample *samples;
    double speeds[HAND_PAPER_BODIES]; // rad/s, largest
} Bench;

typedef struct Way {
    const char *name;
    double first; // tolerance, or step, s
    double share; // of a rung to the one before
    size_t rungs;
    // Runs a rung and returns its error, or NAN.
    double (*run)(Bench *bench, double value);
    double times[RUNG_MAX][ROUNDS]; // s
    double errors[RUNG_MAX];
} Way;

static double error_of_hand(const Bench *bench)
{
    double error = 0.0;
    for (size_t k = 0; k < SAMPLES; k++) {
        for (size_t i = 0; i < HAND_PAPER_BODIES; i++) {
            const double omega = trajectory_motion(bench->best, k, FIRST_BODY + i)->omega;
            const double own = fabs(bench->samples[k].omega[i] - omega) / bench->speeds[i];
            error = own <= error ? error : own; // a NaN stays
        }
    }
    return error;
}

static double error_of(const Bench *bench, Trajectory *run)
{
    double error = run->is_complete ? 0.0 : NAN;
    for (size_t k = 0; k < SAMPLES && run->is_complete; k++) {
        for (size_t i = 0; i < HAND_PAPER_BODIES; i++) {
            const double omega = trajectory_motion(bench->best, k, FIRST_BODY + i)->omega;
            const double own = trajectory_motion(run, k, FIRST_BODY + i)->omega;
            error = fmax(error, fabs(own - omega) / bench->speeds[i]);
        }
    }
    trajectory_destroy(run);
    return error;
}

static double run_hand(Bench *bench, double value)
{
    return hand_paper_run(value, SAMPLES - 1, bench->samples) > 0 ? error_of_hand(bench) : NAN;
}

static double run_reference(Bench *bench, double value)
{
    Scenario scenario = *bench->scenario;
    scenario.reference.tolerance = value;
    return error_of(bench, tracer_run(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY));
}

static double run_impulse(Bench *bench, double value)
{
    Scenario scenario = *bench->scenario;
    scenario.run.step = value;
    return error_of(bench, tracer_run(&scenario, registry_solver(BACKEND_ODE), NOBODY));
}

static double run_auto(Bench *bench, double value)
{
    Scenario scenario = *bench->scenario;
    scenario.run.step = 0.0;
    scenario.run.tolerance = value;
    return error_of(bench, backend_run(&scenario, BACKEND_ODE, &bench->truth,
                                       (ChosenWatch){NOBODY, NULL}, &TRACER_PROBE));
}

static Way WAYS[] = {
    {"hand-made", 1e-4, 0.31623, 20, run_hand, {{0}}, {0}},
    {"reference", 3e-5, 0.31623, 19, run_reference, {{0}}, {0}},
    {"impulse, fixed step", 200e-6, 0.75, 18, run_impulse, {{0}}, {0}},
    {"step: auto", 1e-2, 1e-2, 3, run_auto, {{0}}, {0}},
};
enum { WAY_COUNT = sizeof WAYS / sizeof *WAYS };

static void run_round(Bench *bench, int round)
{
    for (size_t i = 0; i < WAY_COUNT; i++) {
        Way *way = &WAYS[round % 2 == 0 ? i : WAY_COUNT - 1 - i];
        for (size_t rung = 0; rung < way->rungs; rung++) {
            const double started_s = clock_processor_s();
            way->errors[rung] = way->run(bench, way->first * pow(way->share, (double)rung));
            way->times[rung][round] = clock_processor_s() - started_s;
        }
    }
}

// Of the cheapest run with no more than that error, s; NAN where none has.
static double cheapest(const Way *way, double error)
{
    double least_s = INFINITY;
    for (size_t rung = 0; rung < way->rungs; rung++) {
        double times[ROUNDS];
        memcpy(times, way->times[rung], sizeof times);
        sorted_make(times, ROUNDS);
        const double median_s = sorted_median(times, ROUNDS);
        least_s = way->errors[rung] <= error && median_s < least_s ? median_s : least_s;
    }
    return isfinite(least_s) ? least_s : NAN;
}

static void print_table(void)
{
    printf("%-8s", "error");
    for (size_t i = 0; i < WAY_COUNT; i++) {
        printf(" %22s", WAYS[i].name);
    }
    printf("\n");
    for (size_t k = 0; k < ERROR_COUNT; k++) {
        const double hand_s = cheapest(&WAYS[0], ERRORS[k]);
        printf("%-8.0e", ERRORS[k]);
        for (size_t i = 0; i < WAY_COUNT; i++) {
            const double own_s = cheapest(&WAYS[i], ERRORS[k]);
            if (isnan(own_s)) {
                printf(" %22s", "-");
            } else {
                printf(" %10.2f ms (%5.2f)  ", 1e3 * own_s, own_s / hand_s);
            }
        }
        printf("\n");
    }
}

static void prepare(Bench *bench, Scenario *scenario)
{
    scenario->reference.tolerance = 1e-14;
    bench->best = run_scenario(scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
    scenario->reference.tolerance = reference_options_default().tolerance;
    bench->truth = truth_make(scenario, NOBODY);
    bench->samples = calloc(SAMPLES, sizeof *bench->samples);
    for (size_t k = 0; k < SAMPLES; k++) {
        for (size_t i = 0; i < HAND_PAPER_BODIES; i++) {
            const double omega = trajectory_motion(bench->best, k, FIRST_BODY + i)->omega;
            bench->speeds[i] = fmax(bench->speeds[i], fabs(omega));
        }
    }
}

int main(void)
{
    static const char *const SETTINGS[] = {"run.start=centred", "ode.map=impulse"};
    char path[PATH_SIZE];
    Scenario scenario;
    Err err = {0};
    snprintf(path, sizeof path, "%s/paper/impact-k66.yaml", getenv("JOINTPLAY_CASES"));
    if (!casefile_load(path, SETTINGS, 2, &scenario, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return 1;
    }
    Bench bench = {.scenario = &scenario};
    prepare(&bench, &scenario);
    for (int round = 0; round < ROUNDS; round++) {
        run_round(&bench, round);
    }
    print_table();
    trajectory_destroy(bench.best);
    truth_finish(&bench.truth);
    free(bench.samples);
    scenario_free(&scenario);
    return 0;
}

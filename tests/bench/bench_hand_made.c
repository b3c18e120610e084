// What does generality cost? The paper's case by a program made for it alone, and by this one.
//
// One revolution from the centred start, 3,600 samples. For each error of omega, and of all rates
// by which runs are compared (model/distance.h; here the pin's velocity in its hole decides):
// processor time of the cheapest run that has no more, on a ladder of tolerances or steps, and in
// brackets its ratio to the program made by hand (tests/support/hand_paper.c). Medians over rounds
// in which all rungs of all ways take turns, in either order. Runs of the program find extremes and
// spikes, as `run` has them; trials of `step: auto` count.
#include "base/clock.h"
#include "base/sorted.h"
#include "casefile/casefile.h"
#include "hand_paper.h"
#include "measure/chosen_run.h"
#include "model/distance.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 7, RUNG_MAX = 24, SAMPLES = 3601, BODIES = 3, PATH_SIZE = 1024 };

// of the case: its free bodies, and joints
enum { COUPLER = 1, FOLLOWER, COUPLER_FOLLOWER = 2, FOLLOWER_GROUND };

static const RunWatch NOBODY = {NULL, NULL};

static const double ERRORS[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-11};
enum { ERROR_COUNT = sizeof ERRORS / sizeof *ERRORS };

static const char *const MEASURES[] = {"of omega", "of all rates"};
enum { OF_OMEGA, OF_ALL, MEASURE_COUNT };

// What a run cost and how far it is off.
typedef struct Ran {
    double spent_s; // processor time
    double errors[MEASURE_COUNT];
} Ran;

typedef struct Bench {
    const Scenario *scenario;
    Trajectory *best;      // what errors are measured against
    DistanceMeasure rates; // of best
    Truth truth;           // what auto is held against
    HandPaperSample *samples;
    double speeds[HAND_PAPER_BODIES]; // rad/s, largest
} Bench;

typedef struct Way {
    const char *name;
    double first; // tolerance, or step, s
    double share; // of a rung to the one before
    size_t rungs;
    Ran (*run)(Bench *bench, double value);
    double times[RUNG_MAX][ROUNDS]; // s
    double errors[RUNG_MAX][MEASURE_COUNT];
} Way;

static void keep_larger(double *largest, double own)
{
    *largest = own <= *largest ? *largest : own; // a NaN stays
}

// How a body moves where a joint holds it, m/s.
static Vec2 speed_at(const Bench *bench, const Motion *motions, size_t joint, int body)
{
    const Joint *held = &bench->best->linkage.joints[joint];
    const JointEnd first = linkage_end(held, 0);
    const JointEnd end = first.body == body ? first : linkage_end(held, 1);
    return linkage_point_velocity(motions, body, end.anchor);
}

// The motion of the bodies at a sample of the program made by hand.
static void motions_of_hand(const Bench *bench, size_t k, Motion motions[BODIES])
{
    const HandPaperSample *sample = &bench->samples[k];
    memcpy(motions, trajectory_motion(bench->best, k, 0), BODIES * sizeof *motions);
    for (int i = 0; i < HAND_PAPER_BODIES; i++) {
        Motion *motion = &motions[COUPLER + i];
        // a link may be measured from its other end
        motion->angle += remainder(sample->angle[i] - motion->angle, M_PI);
        motion->omega = sample->omega[i];
        motion->velocity = (Vec2){0.0, 0.0};
    }
    // the follower turns about its pivot, the coupler hangs on the follower
    const Vec2 pivot = speed_at(bench, motions, FOLLOWER_GROUND, FOLLOWER);
    motions[FOLLOWER].velocity = vec2_sub(motions[FOLLOWER].velocity, pivot);
    motions[COUPLER].velocity = vec2_sub(speed_at(bench, motions, COUPLER_FOLLOWER, FOLLOWER),
                                         speed_at(bench, motions, COUPLER_FOLLOWER, COUPLER));
}

// Adds the errors of one sample.
static void add_errors(const Bench *bench, size_t k, const Motion *motions, Ran *ran)
{
    for (size_t i = 0; i < HAND_PAPER_BODIES; i++) {
        const double omega = trajectory_motion(bench->best, k, COUPLER + i)->omega;
        keep_larger(&ran->errors[OF_OMEGA],
                    fabs(motions[COUPLER + i].omega - omega) / bench->speeds[i]);
    }
    keep_larger(&ran->errors[OF_ALL], distance_apart(&bench->rates, (DistanceMotion){motions, NULL},
                                                     distance_motion_at(bench->best, k), NULL));
}

static Ran run_hand(Bench *bench, double value)
{
    const double started_s = clock_processor_s();
    const size_t evaluations = hand_paper_run(value, SAMPLES - 1, bench->samples);
    Ran ran = {.spent_s = clock_processor_s() - started_s};
    Motion motions[BODIES];
    for (size_t k = 0; k < SAMPLES; k++) {
        motions_of_hand(bench, k, motions);
        add_errors(bench, k, motions, &ran);
    }
    return evaluations > 0 ? ran : (Ran){ran.spent_s, {NAN, NAN}};
}

// What a run of the program that began then was.
static Ran judge(const Bench *bench, double started_s, Trajectory *run)
{
    Ran ran = {.spent_s = clock_processor_s() - started_s};
    for (size_t k = 0; k < SAMPLES && run->is_complete; k++) {
        add_errors(bench, k, trajectory_motion(run, k, 0), &ran);
    }
    const bool is_complete = run->is_complete;
    trajectory_destroy(run);
    return is_complete ? ran : (Ran){ran.spent_s, {NAN, NAN}};
}

static Ran run_reference(Bench *bench, double value)
{
    Scenario scenario = *bench->scenario;
    scenario.reference.tolerance = value;
    const double started_s = clock_processor_s();
    return judge(bench, started_s,
                 tracer_run(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY));
}

static Ran run_impulse(Bench *bench, double value)
{
    Scenario scenario = *bench->scenario;
    scenario.run.step = value;
    const double started_s = clock_processor_s();
    return judge(bench, started_s, tracer_run(&scenario, registry_solver(BACKEND_ODE), NOBODY));
}

static Ran run_auto(Bench *bench, double value)
{
    Scenario scenario = *bench->scenario;
    scenario.run.step = 0.0;
    scenario.run.tolerance = value;
    const double started_s = clock_processor_s();
    return judge(bench, started_s,
                 backend_run(&scenario, BACKEND_ODE, &bench->truth, (ChosenWatch){.run = NOBODY},
                             &TRACER_PROBE));
}

static Way WAYS[] = {
    {"hand-made", 1e-4, 0.31623, 20, run_hand, {{0}}, {{0}}},
    {"reference", 3e-5, 0.31623, 19, run_reference, {{0}}, {{0}}},
    {"impulse, fixed step", 200e-6, 0.75, 18, run_impulse, {{0}}, {{0}}},
    {"step: auto", 1e-1, 0.31623, 11, run_auto, {{0}}, {{0}}},
};
enum { WAY_COUNT = sizeof WAYS / sizeof *WAYS };

static void run_round(Bench *bench, int round)
{
    for (size_t i = 0; i < WAY_COUNT; i++) {
        Way *way = &WAYS[round % 2 == 0 ? i : WAY_COUNT - 1 - i];
        for (size_t rung = 0; rung < way->rungs; rung++) {
            const Ran ran = way->run(bench, way->first * pow(way->share, (double)rung));
            memcpy(way->errors[rung], ran.errors, sizeof ran.errors);
            way->times[rung][round] = ran.spent_s;
        }
    }
}

// Of the cheapest run with no more than that error, s; NAN where none has.
static double cheapest(const Way *way, int measure, double error)
{
    double least_s = INFINITY;
    for (size_t rung = 0; rung < way->rungs; rung++) {
        double times[ROUNDS];
        memcpy(times, way->times[rung], sizeof times);
        sorted_make(times, ROUNDS);
        const double median_s = sorted_median(times, ROUNDS);
        least_s = way->errors[rung][measure] <= error && median_s < least_s ? median_s : least_s;
    }
    return isfinite(least_s) ? least_s : NAN;
}

static void print_table(int measure)
{
    printf("error %s\n%-8s", MEASURES[measure], "");
    for (size_t i = 0; i < WAY_COUNT; i++) {
        printf(" %22s", WAYS[i].name);
    }
    printf("\n");
    for (size_t k = 0; k < ERROR_COUNT; k++) {
        const double hand_s = cheapest(&WAYS[0], measure, ERRORS[k]);
        printf("%-8.0e", ERRORS[k]);
        for (size_t i = 0; i < WAY_COUNT; i++) {
            const double own_s = cheapest(&WAYS[i], measure, ERRORS[k]);
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
    bench->rates = distance_measure(bench->best);
    scenario->reference.tolerance = reference_options_default().tolerance;
    bench->truth = truth_make(scenario, NOBODY);
    bench->samples = calloc(SAMPLES, sizeof *bench->samples);
    for (size_t k = 0; k < SAMPLES; k++) {
        for (size_t i = 0; i < HAND_PAPER_BODIES; i++) {
            const double omega = trajectory_motion(bench->best, k, COUPLER + i)->omega;
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
    for (int measure = 0; measure < MEASURE_COUNT; measure++) {
        print_table(measure);
    }
    distance_finish(&bench.rates);
    trajectory_destroy(bench.best);
    truth_finish(&bench.truth);
    free(bench.samples);
    scenario_free(&scenario);
    return 0;
}

// How far is the paper's four-bar off that somebody makes by hand of ODE's hinges and a pin of the
// library, beside the program's own world of the same case, at equal steps?
//
// hand_four_bar_error [TURNS [FRICTION [ERP]]]
// FRICTION is the pin's coefficient, ERP that of the hinges (1.5).
// For plain, staggered and impulse stepping: the largest difference of omega of coupler or follower
// from the reference at any sample, relative to the body's largest, of the program and of the
// library; steps of ODE's world, fallbacks, and processor time a step of either.
#include "hand_four_bar.h"

#include "casefile/casefile.h"
#include "run/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { STEP_COUNT = 5, STEPPING_COUNT = 3 };

static const double STEPS_S[STEP_COUNT] = {20e-6, 10e-6, 5e-6, 2e-6, 1e-6};
static const double SAMPLE_S = 20e-6; // a multiple of all of them
static const double TURN_S = 0.06;

// One way to step, in the program's words and in the library's.
typedef struct Way {
    const char *name;
    const char *overrides[2];
    JpStepping stepping;
} Way;

static const Way WAYS[STEPPING_COUNT] = {
    {"plain", {"ode.stepping=plain", "ode.map=corrected"}, JP_STEPPING_PLAIN},
    {"staggered", {"ode.stepping=staggered", "ode.map=midpoint"}, JP_STEPPING_STAGGERED},
    {"impulse", {"ode.stepping=staggered", "ode.map=impulse"}, JP_STEPPING_IMPULSE},
};

typedef struct Outcome {
    double error;
    size_t world_steps;
    size_t fallbacks;
    double step_us; // processor time
} Outcome;

// What may be asked for.
typedef struct Asked {
    double turns;
    double friction;
    double erp;
} Asked;

static bool load(const Way *way, const Asked *asked, double step_s, Scenario *scenario)
{
    char words[4][64];
    snprintf(words[0], sizeof words[0], "run.revolutions=%.17g", asked->turns);
    snprintf(words[3], sizeof words[3], "contact.friction=%.17g", asked->friction);
    snprintf(words[1], sizeof words[1], "run.samples=%.0f", TURN_S / SAMPLE_S);
    snprintf(words[2], sizeof words[2], "run.step=%.17g s", step_s);
    const char *const all[] = {"run.start=centred", words[0],         words[1], words[2], words[3],
                               way->overrides[0],   way->overrides[1]};
    Err err = {ERR_NONE, ""};
    if (!casefile_load("cases/paper/impact-k66.yaml", all, 7, scenario, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return false;
    }
    return true;
}

static double seconds(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

static Outcome run_program(const Scenario *scenario, const Trajectory *truth)
{
    const double start = seconds();
    Trajectory *run = run_scenario(scenario, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
    const double taken = seconds() - start;
    Outcome outcome = {
        .error = run->is_complete ? hand_four_bar_run_error(run, truth) : NAN,
        .world_steps = run->steps,
    };
    outcome.step_us = 1e6 * taken / (double)run->steps;
    trajectory_destroy(run);
    return outcome;
}

static Outcome run_library(const Scenario *scenario, const Way *way, double erp,
                           const Trajectory *truth)
{
    const double step_s = scenario->run.step;
    const HandOptions options = hand_four_bar_options(scenario, way->stepping, erp);
    HandMotion start[HAND_BODIES];
    hand_four_bar_start(truth, start);
    HandFourBar bar;
    JpError error;
    Outcome outcome = {.error = NAN};
    double taken = 0.0;
    if (!hand_four_bar_make(&options, start, &bar, &error)) {
        fprintf(stderr, "%s\n", error.text);
        return outcome;
    }
    const size_t between = (size_t)lround(SAMPLE_S / step_s);
    outcome.error = 0.0;
    for (size_t k = 1; k < truth->sample_count; k++) {
        const double before = seconds();
        for (size_t i = 0; i < between; i++) {
            if (jp_world_step(bar.play, step_s, &error) > JP_OK) {
                fprintf(stderr, "%s\n", error.text);
                outcome.error = NAN;
            }
        }
        taken += seconds() - before;
        outcome.error = fmax(outcome.error, hand_four_bar_error(&bar, truth, k));
    }
    JpWorldStats stats;
    jp_world_stats(bar.play, &stats, NULL);
    outcome.world_steps = stats.world_steps;
    outcome.fallbacks = stats.fallbacks;
    outcome.step_us = 1e6 * taken / (double)stats.steps;
    hand_four_bar_destroy(&bar);
    return outcome;
}

static void compare(const Way *way, const Asked *asked)
{
    for (size_t i = 0; i < STEP_COUNT; i++) {
        Scenario scenario;
        if (!load(way, asked, STEPS_S[i], &scenario)) {
            return;
        }
        Trajectory *truth =
            run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
        const Outcome program = run_program(&scenario, truth);
        const Outcome library = run_library(&scenario, way, asked->erp, truth);
        printf("| %s | %.3g | %.2e | %.2e | %.2f | %zu | %zu | %zu | %.1f | %.1f |\n", way->name,
               1e6 * STEPS_S[i], program.error, library.error, library.error / program.error,
               program.world_steps, library.world_steps, library.fallbacks, program.step_us,
               library.step_us);
        trajectory_destroy(truth);
        scenario_free(&scenario);
    }
}

int main(int count, char **words)
{
    const Asked asked = {
        .turns = count > 1 ? strtod(words[1], NULL) : 1.0,
        .friction = count > 2 ? strtod(words[2], NULL) : 0.0,
        .erp = count > 3 ? strtod(words[3], NULL) : 1.5,
    };
    dInitODE2(0);
    printf("| stepping | step, us | error, program | library | ratio | world steps, program | "
           "library | fallbacks | time a step, us, program | library |\n");
    printf("|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < STEPPING_COUNT; i++) {
        compare(&WAYS[i], &asked);
    }
    dCloseODE();
    return 0;
}

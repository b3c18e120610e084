// How far off are a world of the library and the program's own run of the same case, at equal
// steps with contacts integrated within them?
//
// library_error STEPS CASE [SETTING...]
// STEPS are in us, such as 250,130,60; CASE is a file, or KIND:SEED of random_case. The world is
// the one that `tune --code` writes (commands/tune/tune_program.h). Errors are the largest of any
// rate, over its own largest, against the reference at the ends of steps.
// One line a step: of the program its error, of it without the change of responses in a step, of
// the library its error, its steps of ODE's world a step, and fallbacks.
#include "random_scenario.h"

#include "casefile/casefile.h"
#include "commands/tune/tune_program.h"
#include "commands/tune/tune_world.h"
#include "measure/error.h"
#include "ode/engine.h"
#include "run/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SETTINGS_MOST = 32 };

static const double TOLERANCE = 1e-11; // of the reference
static const RunWatch NOBODY = {NULL, NULL};

static const CaseKind *const KINDS[] = {
    &CASE_FOUR_BAR, &CASE_BODIES, &CASE_PENDULA, &CASE_FOUR_BARS, &CASE_SPRUNG,  &CASE_SLIDERS,
    &CASE_TOUCHING, &CASE_LIMITS, &CASE_HOLES,   &CASE_ROTORS,    &CASE_RUN_UPS,
};

static bool load(const char *name, const char *const *settings, size_t count, Scenario *scenario,
                 Err *err)
{
    const char *colon = strchr(name, ':');
    for (size_t i = 0; colon != NULL && i < sizeof KINDS / sizeof *KINDS; i++) {
        const size_t length = strlen(KINDS[i]->name);
        if (length == (size_t)(colon - name) && strncmp(KINDS[i]->name, name, length) == 0) {
            return random_scenario(KINDS[i], strtoull(colon + 1, NULL, 10), settings, count,
                                   scenario, err);
        }
    }
    return casefile_load(name, settings, count, scenario, err);
}

static double error_of(const Scenario *scenario, const Solver *solver, const Trajectory *truth)
{
    Trajectory *run = run_motion(scenario, solver, NOBODY);
    const double error = run->is_complete ? error_against(run, truth, INFINITY).max : NAN;
    if (!run->is_complete) {
        fprintf(stderr, "%s: %s\n", solver->name, run->message);
    }
    trajectory_destroy(run);
    return error;
}

// What the library's world counts over the whole motion.
static SolverModel count(const Scenario *scenario)
{
    const Solver *solver = tune_program_solver();
    void *state = NULL;
    Err err = {ERR_NONE, ""};
    SolverModel model = {.steps = 0};
    const double end_s = scenario_sample_time(scenario, scenario_sample_count(scenario) - 1);
    double reached_s = 0.0;
    if (solver->open(scenario, &state, &err)) {
        while (reached_s < end_s - 1e-3 * scenario->run.step &&
               solver->stride(state, end_s, &reached_s, &err)) {
        }
        model = solver->model(state);
        solver->close(state);
        model.stepped_s = reached_s;
    }
    return model;
}

static void compare(const Scenario *scenario, double step_s)
{
    Scenario own = *scenario;
    own.run.step = step_s;
    own.run.interval = tune_world_every(&own) * step_s;
    Scenario finer = own;
    finer.reference.tolerance = TOLERANCE;
    Trajectory *truth = run_motion(&finer, registry_solver(BACKEND_REFERENCE), NOBODY);
    Scenario frozen = own;
    frozen.ode.is_frozen = true;
    const SolverModel model = count(&own);
    printf("%8.3g %9.2e %9.2e %9.2e %6.2f %4zu\n", 1e6 * step_s,
           error_of(&own, registry_solver(BACKEND_ODE), truth),
           error_of(&frozen, registry_solver(BACKEND_ODE), truth),
           error_of(&own, tune_program_solver(), truth),
           (double)model.steps * step_s / model.stepped_s, model.fallback_rows);
    trajectory_destroy(truth);
}

int main(int argc, char **argv)
{
    if (argc < 3 || argc - 3 > SETTINGS_MOST - 2) {
        fprintf(stderr, "usage: library_error STEPS CASE [SETTING...]\n");
        return 2;
    }
    const char *settings[SETTINGS_MOST] = {"ode.stepping=staggered", "ode.map=impulse"};
    for (int i = 3; i < argc; i++) {
        settings[i - 1] = argv[i];
    }
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    if (!load(argv[2], settings, (size_t)argc - 1, &scenario, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return 1;
    }
    const char *lacks = tune_world_lacks(&scenario);
    if (lacks != NULL) {
        fprintf(stderr, "%s\n", lacks);
        return 1;
    }
    printf("# %s\n# step us, program, frozen, library, steps of ODE a step, fallbacks\n", argv[2]);
    for (const char *at = argv[1]; *at != '\0';) {
        char *end;
        compare(&scenario, 1e-6 * strtod(at, &end));
        at = *end == ',' ? end + 1 : end;
    }
    scenario_free(&scenario);
    return 0;
}

// How many times faster than real time does each mechanism run, at which error?
//
// Simulated time over processor time of the run alone; medians over repetitions in which all ways
// to run a case take turns. Error: of omega against the certified reference up to its horizon, as
// `run` prints it. The last column is the time beside that of the reference at its default
// tolerance in the same turns. "-": the case cannot be run that way, takes too
// many steps, or failed.
#include "casefile/casefile.h"
#include "measure/error.h"
#include "measure/scheme.h"
#include "measure/truth.h"
#include "run/registry.h"

#include "base/clock.h"
#include "base/sorted.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REPETITIONS = 3, PATH_SIZE = 1024, WAY_COUNT = 9 };

// a way that takes more steps than this is left out
static const double STEP_MOST = 60000.0;

static const RunWatch NOBODY = {NULL, NULL};

static const char *const CASES[] = {
    "paper/impact-k66",
    "literature/four-bar-half-mm",
    "literature/pin-in-hole-drop",
    "mechanisms/slider-crank-pin",
    "mechanisms/slider-crank-guide",
    "mechanisms/newtons-cradle",
    "mechanisms/andrews",
    "space/overhung-pin",
};

// A scheme by its name, with its step, s, or the reference with its tolerance.
typedef struct Way {
    const char *scheme;
    double value;
} Way;

static const Way WAYS[WAY_COUNT] = {
    {"reference", 3e-13},
    {"reference", 1e-9},
    {"reference", 1e-5},
    {"direct/staggered/impulse", 2e-6},
    {"direct/staggered/impulse", 20e-6},
    {"direct/staggered/midpoint", 2e-6},
    {"direct/staggered/midpoint", 20e-6},
    {"direct/plain/textbook", 2e-6},
    {"direct/plain/textbook", 20e-6},
};

typedef struct Figures {
    double processor_s[REPETITIONS];
    double error; // NAN: there is none
} Figures;

// False where the case has no such scheme.
static bool prepare(const Scenario *of_case, const Way *way, Scenario *scenario,
                    BackendKind *backend)
{
    static Scheme schemes[SCHEME_MAX];
    *scenario = scenario_copy(of_case);
    const size_t count = scheme_list(of_case, schemes);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(schemes[i].name, way->scheme) == 0) {
            *backend = schemes[i].backend;
            scheme_apply(&schemes[i], way->value, scenario);
            if (*backend == BACKEND_REFERENCE) {
                scenario->reference.tolerance = way->value;
                return true;
            }
            return scenario_duration(scenario) <= STEP_MOST * way->value;
        }
    }
    return false;
}

static void run_once(const Scenario *of_case, const Truth *truth, const Way *way, int repetition,
                     Figures *figures)
{
    Scenario scenario;
    BackendKind backend;
    figures->error = NAN;
    figures->processor_s[repetition] = NAN;
    if (prepare(of_case, way, &scenario, &backend)) {
        const double started_s = clock_processor_s();
        Trajectory *run = run_scenario(&scenario, registry_solver(backend), NOBODY);
        figures->processor_s[repetition] = clock_processor_s() - started_s;
        if (run->is_complete) {
            const double horizon_s = truth->is_limited ? truth->horizon_s : INFINITY;
            const TrajectoryError error = error_against(run, truth->trajectory, horizon_s);
            const double seen = truth->is_limited ? error.omega_max_in_horizon : error.omega_max;
            // no less than what the reference knows of itself
            figures->error = fmax(seen, truth->uncertainty);
        }
        trajectory_destroy(run);
    }
    scenario_free(&scenario);
}

static void print_case(const char *name, const Scenario *scenario, Figures figures[WAY_COUNT])
{
    const double duration_s = scenario_duration(scenario);
    printf("%s, %.4g ms\n", name, 1e3 * duration_s);
    double reference_s = NAN;
    for (int i = 0; i < WAY_COUNT; i++) {
        sorted_make(figures[i].processor_s, REPETITIONS);
        const double taken_s = sorted_median(figures[i].processor_s, REPETITIONS);
        reference_s = i == 0 ? taken_s : reference_s;
        char value[32];
        const bool is_step = strcmp(WAYS[i].scheme, "reference") != 0;
        snprintf(value, sizeof value, is_step ? "%.4g us" : "%.4g",
                 (is_step ? 1e6 : 1.0) * WAYS[i].value);
        printf("  %-26s %8s", WAYS[i].scheme, value);
        if (isnan(figures[i].error)) {
            printf(" %10s %12s %12s\n", "-", "-", "-");
        } else {
            printf(" %10.1e %12.4g %12.4g\n", figures[i].error, duration_s / taken_s,
                   taken_s / reference_s);
        }
    }
}

static bool measure(const char *name)
{
    char path[PATH_SIZE];
    Scenario scenario;
    Err err = {0};
    snprintf(path, sizeof path, "%s/%s.yaml", getenv("JOINTPLAY_CASES"), name);
    if (!casefile_load(path, NULL, 0, &scenario, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return false;
    }
    Figures figures[WAY_COUNT];
    Truth truth = truth_make(&scenario, NOBODY);
    for (int repetition = 0; repetition < REPETITIONS && truth.trajectory->is_complete;
         repetition++) {
        for (int i = 0; i < WAY_COUNT; i++) {
            const int way = repetition % 2 == 0 ? i : WAY_COUNT - 1 - i;
            run_once(&scenario, &truth, &WAYS[way], repetition, &figures[way]);
        }
    }
    const bool is_known = truth.trajectory->is_complete;
    if (is_known) {
        print_case(name, &scenario, figures);
    } else {
        fprintf(stderr, "%s: %s\n", name, truth.trajectory->message);
    }
    truth_finish(&truth);
    scenario_free(&scenario);
    return is_known;
}

int main(void)
{
    printf("  %-26s %8s %10s %12s %12s\n", "", "", "error", "x real time", "x reference");
    bool are_known = true;
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        are_known = measure(CASES[i]) && are_known;
    }
    return are_known ? 0 : 1;
}

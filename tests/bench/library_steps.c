// The paper's four-bar by libjointplay: revolutions in steps of 20 us with contacts within the
// step, for tests/bench/old_and_new.py, which runs it with the library of either build.
//
// library_steps TURNS: processor time of the steps, s, and the error of omega over a first one.
#include "hand_four_bar.h"

#include "base/clock.h"
#include "casefile/casefile.h"
#include "run/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { STEPS_A_TURN = 3000, PATH_SIZE = 1024 };

static const double STEP_S = 20e-6;
static const double HINGE_ERP = 1.5;

// A turn from the start; returns the processor time of its steps, s.
static double turn(const HandOptions *options, const Trajectory *truth, double *error)
{
    HandMotion start[HAND_BODIES];
    HandFourBar bar;
    JpError reason;
    double spent_s = 0.0;
    hand_four_bar_start(truth, start);
    if (!hand_four_bar_make(options, start, &bar, &reason)) {
        fprintf(stderr, "%s\n", reason.text);
        exit(1);
    }
    for (size_t k = 1; k <= STEPS_A_TURN; k++) {
        const double started_s = clock_processor_s();
        const JpStatus status = jp_world_step(bar.play, STEP_S, &reason);
        spent_s += clock_processor_s() - started_s;
        if (status > JP_OK) {
            fprintf(stderr, "%s\n", reason.text);
            exit(1);
        }
        *error = fmax(*error, hand_four_bar_error(&bar, truth, k));
    }
    hand_four_bar_destroy(&bar);
    return spent_s;
}

int main(int count, char **words)
{
    static const char *const SETTINGS[] = {"run.start=centred", "run.samples=3000"};
    const int turns = count > 1 ? atoi(words[1]) : 1;
    char path[PATH_SIZE];
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    snprintf(path, sizeof path, "%s/paper/impact-k66.yaml", getenv("JOINTPLAY_CASES"));
    if (!casefile_load(path, SETTINGS, 2, &scenario, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return 1;
    }
    dInitODE2(0);
    Trajectory *truth =
        run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
    const HandOptions options = hand_four_bar_options(&scenario, JP_STEPPING_IMPULSE, HINGE_ERP);
    double error = 0.0;
    double spent_s = 0.0;
    for (int i = 0; i < turns; i++) {
        spent_s += turn(&options, truth, &error);
    }
    printf("%.9g %.3g\n", spent_s, error);
    trajectory_destroy(truth);
    scenario_free(&scenario);
    dCloseODE();
    return 0;
}

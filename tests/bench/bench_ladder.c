// Speed against error with ideal joints: plain stepping over a ladder of steps.
//
// Error: largest |omega - omega_analytic| over coupler and follower, each over its largest
// |omega|. Times are medians over repetitions that go up and down the ladder in turn.
#include "mechanism.h"

#include "base/sorted.h"
#include "measure/error.h"
#include "run/registry.h"
#include "run/run.h"

#include <stdio.h>

enum { RUNGS = 5, REPETITIONS = 7 };

static const double STEPS_S[RUNGS] = {1e-4, 3e-5, 1e-5, 3e-6, 1e-6};

typedef struct Rung {
    TrajectoryError error;
    size_t steps;
    double wall_s[REPETITIONS];
} Rung;

static void climb(Scenario *scenario, const Trajectory *truth, int repetition, Rung rungs[RUNGS])
{
    const RunWatch nobody = {NULL, NULL};
    for (int i = 0; i < RUNGS; i++) {
        Rung *rung = &rungs[repetition % 2 == 0 ? i : RUNGS - 1 - i];
        scenario->run.step = STEPS_S[rung - rungs];
        Trajectory *trajectory = run_scenario(scenario, registry_solver(BACKEND_ODE), nobody);
        rung->error = error_against(trajectory, truth, INFINITY);
        rung->steps = trajectory->steps;
        rung->wall_s[repetition] = trajectory->wall_s;
        trajectory_destroy(trajectory);
    }
}

int main(void)
{
    Scenario scenario = mechanism_paper();
    Trajectory *truth =
        run_scenario(&scenario, registry_solver(BACKEND_ANALYTIC), (RunWatch){NULL, NULL});
    Rung rungs[RUNGS];
    for (int repetition = 0; repetition < REPETITIONS; repetition++) {
        climb(&scenario, truth, repetition, rungs);
    }
    printf("%10s %8s %12s %8s %12s %10s %10s\n", "step, us", "steps", "omega error", "order",
           "alpha error", "wall, ms", "us/step");
    for (int i = 0; i < RUNGS; i++) {
        Rung *rung = &rungs[i];
        sorted_make(rung->wall_s, REPETITIONS);
        const double wall = sorted_median(rung->wall_s, REPETITIONS);
        printf("%10.4g %8zu %12.3e ", 1e6 * STEPS_S[i], rung->steps, rung->error.omega_max);
        if (i == 0) {
            printf("%8s", "-");
        } else {
            printf("%8.3f", log(rungs[i - 1].error.omega_max / rung->error.omega_max) /
                                log(STEPS_S[i - 1] / STEPS_S[i]));
        }
        printf(" %12.3e %10.3f %10.3f\n", rung->error.alpha_max, 1e3 * wall,
               1e6 * wall / (double)rung->steps);
    }
    trajectory_destroy(truth);
    return 0;
}

// Prints the angular velocities of coupler and follower at twelve equidistant times.
//     print_truth PROBLEM [TOLERANCE [DURATION_S]]
#include "model/kinematics.h"
#include "problems.h"
#include "quad_truth.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { SAMPLE_COUNT = 12 };

int main(int argc, char **argv)
{
    const int number = argc > 1 ? atoi(argv[1]) : 1;
    if (number < 1 || number > PROBLEM_COUNT) {
        fprintf(stderr, "print_truth: problems are numbered 1 to %d\n", PROBLEM_COUNT);
        return 2;
    }
    const ProblemChoice *choice = &PROBLEMS[number - 1];
    TruthOptions options = truth_options_default();
    options.tolerance = argc > 2 ? atof(argv[2]) : options.tolerance;
    const double duration = argc > 3 ? atof(argv[3]) : choice->duration;
    const Scenario scenario = problem_scenario(choice);
    const QuadProblem problem = quad_problem(&scenario);
    double times[SAMPLE_COUNT];
    for (int i = 0; i < SAMPLE_COUNT; i++) {
        times[i] = duration * (i + 1) / SAMPLE_COUNT;
    }
    TruthSample samples[SAMPLE_COUNT * KINEMATICS_BODY_MAX];
    TruthFigures figures;
    const clock_t start = clock();
    const bool is_complete = truth_run(&problem, &options, SAMPLE_COUNT, times, samples, &figures);
    printf("# %s, tolerance %g m/s: %s, %.3g s\n", choice->name, options.tolerance,
           is_complete ? "complete" : "FAILED", (double)(clock() - start) / CLOCKS_PER_SEC);
    printf("# %zu steps, %zu solves, %zu evaluations, %zu onsets, %zu ends, %zu clamps, drift %.2g "
           "m, deepest %.4g m\n",
           figures.steps, figures.solves, figures.evaluations, figures.onsets, figures.ends,
           figures.clamps, figures.drift_max, figures.depth_max);
    printf("# time_s omega_coupler_rad_s omega_follower_rad_s\n");
    for (int i = 0; i < SAMPLE_COUNT; i++) {
        const TruthSample *bodies = samples + i * 3;
        char coupler[64];
        char follower[64];
        quadmath_snprintf(coupler, sizeof coupler, "%.20Qg", bodies[1].omega);
        quadmath_snprintf(follower, sizeof follower, "%.20Qg", bodies[2].omega);
        printf("%.17g %s %s\n", times[i], coupler, follower);
    }
    return is_complete ? 0 : 1;
}

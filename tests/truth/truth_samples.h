// The truth at the samples of a scenario, for the tests that hold a solver against it.
#pragma once

#include "close.h"
#include "quad_truth.h"

#include <stdlib.h>

// The truth at the scenario's samples; the caller frees it.
static inline TruthSample *truth_at_samples(const Scenario *scenario, const QuadProblem *problem,
                                            TruthFigures *figures)
{
    const size_t count = scenario_sample_count(scenario);
    double *times = calloc(count, sizeof *times);
    TruthSample *samples = calloc(count * problem->body_count, sizeof *samples);
    assert_non_null(times);
    assert_non_null(samples);
    for (size_t k = 0; k < count; k++) {
        times[k] = scenario_sample_time(scenario, k);
    }
    TruthOptions options = truth_options_default();
    options.tolerance = 1e-14; // m/s
    assert_true(truth_run(problem, &options, count, times, samples, figures));
    free(times);
    return samples;
}

// Which samples would a solver without any error write?
#include "truth_trajectory.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

Trajectory *truth_trajectory(const Scenario *scenario, const QuadProblem *problem,
                             const TruthOptions *options, double until_s, TruthFigures *figures)
{
    Trajectory *trajectory = trajectory_create(scenario, "truth");
    const size_t count = trajectory->sample_count;
    double *times = calloc(count, sizeof *times);
    TruthSample *samples = calloc(count * problem->body_count, sizeof *samples);
    assert(times != NULL && samples != NULL);
    size_t wanted = 0;
    for (size_t k = 0; k < count; k++) {
        times[k] = scenario_sample_time(scenario, k);
        wanted = times[k] <= until_s ? k + 1 : wanted;
    }
    truth_run(problem, options, wanted, times, samples, figures);
    for (size_t k = 0; k < count; k++) {
        Sample sample = sample_create(&scenario->linkage);
        sample.time_s = times[k];
        for (size_t i = 0; k < figures->samples && i < problem->body_count; i++) {
            const TruthSample *body = &samples[k * problem->body_count + i];
            sample.bodies[i].position = (Vec2){(double)body->x, (double)body->y};
            sample.bodies[i].angle = (double)body->angle;
            sample.bodies[i].velocity = (Vec2){(double)body->x_rate, (double)body->y_rate};
            sample.bodies[i].omega = (double)body->omega;
            // a difference from a number that is none would count as no error
            assert(isfinite(sample.bodies[i].omega) && isfinite(sample.bodies[i].velocity.x) &&
                   isfinite(sample.bodies[i].velocity.y));
        }
        trajectory_store(trajectory, k, &sample);
        sample_free(&sample);
    }
    trajectory->is_complete = true;
    free(times);
    free(samples);
    return trajectory;
}

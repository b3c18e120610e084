// How do the bodies of a scenario move, for who compares two motions and needs no more?
//
// As in run/run.c, with nothing recorded at the steps.
#include "base/clock.h"
#include "model/lock.h"
#include "run/run.h"
#include "run/sample_check.h"

#include <stdio.h>

// steps between two looks at the clock
enum { PROGRESS_EVERY = 64 };

typedef struct Way {
    const Scenario *scenario;
    const Solver *solver;
    void *state;
    RunWatch watch;
    double started_s; // by the clock
    size_t steps;
    double reached_s; // simulated
    double width_s;   // length of the last step
} Way;

static bool stride(Way *way, double stop_s, Err *err)
{
    double end_s = 0.0;
    if (!solver_stride(way->solver, way->state, stop_s, &end_s, err)) {
        return false;
    }
    way->width_s = end_s - way->reached_s;
    way->reached_s = end_s;
    way->steps++;
    if (way->watch.progress != NULL && way->steps % PROGRESS_EVERY == 0) {
        way->watch.progress(way->reached_s / scenario_duration(way->scenario),
                            clock_now_s() - way->started_s, way->watch.context);
    }
    return true;
}

static bool reach(Way *way, double time_s, Err *err)
{
    while (way->reached_s < time_s - RUN_ROUNDING * way->width_s) {
        if (!stride(way, time_s, err)) {
            return false;
        }
    }
    return true;
}

static bool go(Way *way, Sample *sample, Trajectory *trajectory, Err *err)
{
    // a first step, so that the sample at zero already stands in one
    if (!stride(way, scenario_sample_time(way->scenario, 1), err)) {
        return false;
    }
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        sample->time_s = scenario_sample_time(way->scenario, k);
        if (!reach(way, sample->time_s, err)) {
            return false;
        }
        solver_glance(way->solver, way->state, sample->time_s, sample);
        if (!run_check_sample(&way->scenario->linkage, NULL, sample, err)) {
            return false;
        }
        trajectory_store_motion(trajectory, k, sample);
    }
    return reach(way, scenario_duration(way->scenario), err);
}

Trajectory *run_motion(const Scenario *scenario, const Solver *solver, RunWatch watch)
{
    Trajectory *trajectory = trajectory_create_motion(scenario, solver->name);
    Err err = {ERR_NONE, ""};
    Way way = {.scenario = scenario, .solver = solver, .watch = watch, .started_s = clock_now_s()};
    if (trajectory->sample_count == 0) {
        return trajectory;
    }
    if (!solver->open(scenario, &way.state, &err)) {
        snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
        return trajectory;
    }
    Sample sample = sample_create(&scenario->linkage);
    trajectory->is_complete = go(&way, &sample, trajectory, &err);
    trajectory->duration_s = way.reached_s;
    lock_explain(scenario, way.reached_s, &err);
    snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
    solver->close(way.state);
    sample_free(&sample);
    return trajectory;
}

// How does one scenario on one solver become one trajectory?
//
// open -> (step -> record)* until the next sample -> observe -> ... -> close. The clock runs around
// the stepping loop alone: steps, contact detection, recording and samples, not the setting up.
#include "run/run.h"

#include "run/recorder.h"

#include <stdio.h>
#include <time.h>

enum { PROGRESS_EVERY = 4096 }; // steps between two looks at the clock: some 10 ms

static double now_s(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

typedef struct Loop {
    const Scenario *scenario;
    const Solver *solver;
    void *state;
    Recorder recorder;
    RunWatch watch;
    double started_s; // by the clock
    size_t steps;
    double reached_s; // simulated
} Loop;

static bool take_step(Loop *loop, double stop_s, Err *err)
{
    if (!loop->solver->step(loop->state, stop_s, err)) {
        return false;
    }
    const StepRecord record = loop->solver->record(loop->state);
    recorder_add(&loop->recorder, &record);
    loop->reached_s = record.end_s;
    loop->steps++;
    if (loop->watch.progress != NULL && loop->steps % PROGRESS_EVERY == 0) {
        loop->watch.progress(loop->reached_s / scenario_duration(loop->scenario),
                             now_s() - loop->started_s, loop->watch.context);
    }
    return true;
}

// Keeps each body's angle in the turn nearest to the sample before.
static void unwrap_angles(const Trajectory *trajectory, size_t index, const Scenario *scenario,
                          Sample *sample)
{
    for (size_t i = 0; i < trajectory->body_count; i++) {
        const double before = index > 0 ? trajectory_motion(trajectory, index - 1, i)->angle
                                        : scenario->linkage.bodies[i].start.angle;
        double *angle = &sample->bodies[i].angle;
        *angle += 2.0 * M_PI * round((before - *angle) / (2.0 * M_PI));
    }
}

static bool run_samples(Loop *loop, Trajectory *trajectory, Err *err)
{
    // a first step, so that the sample at zero already stands in one
    if (!take_step(loop, scenario_sample_time(loop->scenario, 1), err)) {
        return false;
    }
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        const double time_s = scenario_sample_time(loop->scenario, k);
        while (loop->reached_s < time_s) {
            if (!take_step(loop, time_s, err)) {
                return false;
            }
        }
        Sample sample = {.time_s = time_s};
        loop->solver->observe(loop->state, time_s, &sample);
        unwrap_angles(trajectory, k, loop->scenario, &sample);
        trajectory_store(trajectory, k, &sample);
    }
    return true;
}

static void fill_model(const Loop *loop, Trajectory *trajectory)
{
    const SolverModel model = loop->solver->model(loop->state);
    snprintf(trajectory->label, sizeof trajectory->label, "%s", model.label);
    trajectory->step_s = model.step_s;
    trajectory->steps = model.steps;
    trajectory->constraint_rows = model.constraint_rows;
    trajectory->contact_rows = model.contact_rows;
}

Trajectory *run_scenario(const Scenario *scenario, const Solver *solver, RunWatch watch)
{
    Trajectory *trajectory = trajectory_create(scenario, solver->name);
    Err err = {ERR_NONE, ""};
    Loop loop = {.scenario = scenario, .solver = solver, .watch = watch};
    if (!solver->open(scenario, &loop.state, &err)) {
        snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
        return trajectory;
    }
    loop.recorder = recorder_start(scenario, trajectory);
    loop.started_s = now_s();
    const bool is_done = run_samples(&loop, trajectory, &err);
    trajectory->wall_s = now_s() - loop.started_s;
    recorder_finish(&loop.recorder);
    fill_model(&loop, trajectory);
    trajectory->duration_s = loop.reached_s;
    if (is_done && solver->extremes != NULL) {
        solver->extremes(loop.state, trajectory->bodies);
    }
    trajectory->is_complete = is_done;
    snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
    solver->close(loop.state);
    return trajectory;
}

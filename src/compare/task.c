// What does one child of a comparison do?
#include "compare/task.h"

#include "base/clock.h"
#include "base/shorten.h"
#include "run/registry.h"

#include <math.h>
#include <stdio.h>

static const RunWatch NOBODY = {NULL, NULL};

Task task_make(const Ladder *ladder, const Scenario *scenario, LadderRun run, const Truth *truth)
{
    const LadderPoint *point = &ladder->points[run.point];
    const Scheme *scheme = &ladder->schemes[point->scheme];
    Task task = {
        .scenario = *scenario,
        .backend = scheme->backend,
        .run = run,
        .truth = truth == NULL ? NULL : truth->trajectory,
        .horizon_s = truth != NULL && truth->is_limited ? truth->horizon_s : INFINITY,
    };
    scheme_apply(scheme, point->step_s, &task.scenario);
    return task;
}

void task_measure(const void *context, void *result)
{
    const Task *task = context;
    LadderRun *run = result;
    *run = task->run;
    const double started_s = clock_processor_s();
    Trajectory *trajectory = run_scenario(&task->scenario, registry_solver(task->backend), NOBODY);
    run->processor_s = clock_processor_s() - started_s;
    run->is_complete = trajectory->is_complete;
    shorten_copy(run->message, sizeof run->message, trajectory->message);
    run->steps = trajectory->steps;
    run->evaluations = trajectory->evaluations;
    run->wall_s = trajectory->wall_s;
    run->hash = trajectory->hash;
    if (run->kind == LADDER_ERROR && trajectory->is_complete) {
        run->error = error_against(trajectory, task->truth, task->horizon_s);
        run->error.against = NULL;
    }
    trajectory_destroy(trajectory);
}

void task_certify(const void *context, void *packed)
{
    const Task *task = context;
    Truth truth = truth_make(&task->scenario, NOBODY);
    truth_pack_write(&truth, packed);
    truth_finish(&truth);
}

void task_spread(const void *context, void *result)
{
    const Task *task = context;
    ensemble_run(&task->scenario, registry_solver(task->backend), NOBODY, result);
}

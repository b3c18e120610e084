// The work of one child process of a comparison, and the truth computed in a child process.
#include "measure/task.h"
#include "base/clock.h"
#include "base/printable.h"
#include "base/side_by_side.h"
#include "measure/child.h"
#include "measure/chosen_run.h"
#include "measure/truth.h"
#include "run/registry.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const RunWatch NOBODY = {NULL, NULL};

// of the five runs that most truths consist of, two begin when another has ended; and each thread
// reserves address space, of which a child has but so much
enum { CERTIFYING_THREADS = 4 };

Task task_make(const Ladder *ladder, const Scenario *scenario, LadderRun run, const Truth *truth)
{
    const LadderPoint *point = &ladder->points[run.point];
    const Scheme *scheme = &ladder->schemes[point->scheme];
    Task task = {
        .scenario = *scenario,
        .backend = scheme->backend,
        .driver = scheme->driver,
        .way = scheme->way,
        .run = run,
        .truth = truth == NULL || truth->trajectory == NULL ? NULL : truth,
    };
    scheme_apply(scheme, point->step_s, &task.scenario);
    return task;
}

// The trajectory of a task, and what another engine says beside it.
static Trajectory *task_trajectory(const Task *task, const Truth *truth, EngineSaid *said)
{
    if (task->driver != NULL) {
        return engine_run(task->driver, task->way, &task->scenario, 0.0, said);
    }
    return backend_run(&task->scenario, task->backend, truth, (ChosenWatch){.begin = NULL},
                       task->run.kind == LADDER_ERROR ? backend_run_probe(&task->scenario) : NULL);
}

// Another engine says of a run what it did at the samples: what is between them is not known.
static void forget_between_samples(TrajectoryError *error)
{
    error->alpha_max = NAN;
    error->peak_force_max = error->peak_force_max_in_horizon = NAN;
    error->peak_alpha_max = error->peak_alpha_max_in_horizon = NAN;
    error->peak_force_in[0] = error->peak_alpha_in[0] = '\0';
    error->energy_lost = NAN;
}

void task_measure(const void *context, void *result)
{
    const Task *task = context;
    LadderRun *run = result;
    *run = task->run;
    // the reference that a step is chosen against is no part of the time
    Truth own = {.trajectory = NULL};
    const Truth *truth = task->truth;
    if (truth == NULL && task->driver == NULL &&
        backend_run_is_chosen(&task->scenario, task->backend)) {
        own = truth_make(&task->scenario, NOBODY);
        truth = &own;
    }
    const double started_s = clock_processor_s();
    EngineSaid said = {.settings = ""};
    Trajectory *trajectory = task_trajectory(task, truth, &said);
    run->processor_s = clock_processor_s() - started_s;
    run->is_complete = trajectory->is_complete;
    shorten_copy(run->message, sizeof run->message,
                 trajectory->is_complete ? said.settings : trajectory->message);
    run->steps = trajectory->steps;
    run->evaluations = trajectory->evaluations;
    run->wall_s = trajectory->wall_s;
    run->hash = trajectory->hash;
    if (run->kind == LADDER_ERROR && trajectory->is_complete) {
        const double horizon_s = truth->is_limited ? truth->horizon_s : INFINITY;
        run->error = error_against(trajectory, truth->trajectory, horizon_s);
        run->error.against = NULL;
        if (task->driver != NULL) {
            forget_between_samples(&run->error);
        }
    }
    truth_finish(&own);
    trajectory_destroy(trajectory);
}

LadderRun task_run(LadderRun asked, const LadderRun *result, const Child *child)
{
    char words[CHILD_TEXT_SIZE];
    if (child->end == CHILD_DONE) {
        return *result;
    }
    child_describe(child, words);
    asked.is_lost = true;
    snprintf(asked.message, sizeof asked.message, "the run's process %s", words);
    return asked;
}

static void certify_on(const Task *task, size_t threads, void *packed)
{
    Truth truth = truth_make_on(&task->scenario, NOBODY, threads);
    truth_pack_write(&truth, packed);
    truth_finish(&truth);
}

void task_certify(const void *task, void *packed)
{
    certify_on(task, 1, packed);
}

static void task_certify_alone(const void *task, void *packed)
{
    const size_t processors = side_by_side_processors();
    certify_on(task, processors < CERTIFYING_THREADS ? processors : CERTIFYING_THREADS, packed);
}

void task_spread(const void *context, void *result)
{
    const Task *task = context;
    const Solver *solver = registry_solver(task->backend);
    if (!backend_run_is_chosen(&task->scenario, task->backend)) {
        ensemble_run(&task->scenario, solver, 0.0, NOBODY, result);
        return;
    }
    // a step that was chosen once is good for starts beside this one
    Ensemble *ensemble = result;
    Trajectory *run = backend_run(&task->scenario, task->backend, task->truth,
                                  (ChosenWatch){.begin = NULL}, NULL);
    if (run->is_complete) {
        const Scenario scenario = chosen_run_scenario(&task->scenario, run->step_s);
        ensemble_run(&scenario, solver, 0.0, NOBODY, ensemble);
    } else {
        *ensemble = (Ensemble){.failed = ENSEMBLE_MEMBERS};
        memcpy(ensemble->message, run->message, sizeof ensemble->message);
    }
    trajectory_destroy(run);
}

// The truth, computed in a child process, so that a crash cannot take the program down.

typedef struct Making {
    const TruthChild *work;
    Task *task;
    Truth *truth;
    bool is_begun;
    bool is_stopped;
} Making;

static bool task_next(void *owner, size_t *number, const void **context)
{
    Making *making = owner;
    *number = 0;
    *context = making->task;
    const bool is_first = !making->is_begun;
    making->is_begun = true;
    return is_first;
}

static bool task_take(void *owner, size_t number, const void *packed, const Child *child, Err *err)
{
    (void)number;
    Making *making = owner;
    if (child->end != CHILD_DONE) {
        char words[CHILD_TEXT_SIZE];
        child_describe(child, words);
        return err_set(err, ERR_SOLVER, "there is no reference to compare with: its process %s",
                       words);
    }
    *making->truth = truth_pack_read(making->work->scenario, packed);
    const Trajectory *trajectory = making->truth->trajectory;
    return trajectory->is_complete ||
           err_set(err, ERR_SOLVER, "there is no reference to compare with: %s",
                   trajectory->message);
}

static bool task_wait(void *owner)
{
    Making *making = owner;
    const TruthChild *work = making->work;
    making->is_stopped = work->should_stop != NULL && work->should_stop(work->context);
    work->wait("making and certifying the reference", work->context);
    return !making->is_stopped;
}

bool truth_child_make(const TruthChild *work, Truth *truth, Err *err)
{
    Making making = {.work = work, .task = calloc(1, sizeof *making.task), .truth = truth};
    assert(making.task != NULL);
    making.task->scenario = *work->scenario;
    *truth = (Truth){.trajectory = NULL};
    const Pool pool = {
        .jobs = 1,
        .work = task_certify_alone,
        .result_size = truth_pack_size(work->scenario),
        .limits = {.time_s = TASK_TRUTH_RUNS * work->run_limit_s,
                   .memory_bytes = TASK_MEMORY_LIMIT},
        .next = task_next,
        .take = task_take,
        .wait = task_wait,
        .owner = &making,
    };
    bool is_made = pool_run(&pool, err);
    if (making.is_stopped) {
        is_made = err_set(err, ERR_SOLVER, "stopped");
    }
    if (!is_made) {
        truth_finish(truth);
    }
    free(making.task);
    return is_made;
}

// What is the error of the program that --code writes?
//
// libjointplay steps a world that knows no more than ODE says: its ideal joints drift and its
// impacts fall otherwise between the steps than in a run of the case. So the world of the program
// is built with the same calls in a process of its own, and held against the reference at exactly
// the times that the program prints.
#include "commands/tune/tune_program.h"

#include "commands/tune/library_world.h"
#include "commands/tune/tune_world.h"
#include "measure/pool.h"
#include "run/registry.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// shorter steps that are tried: a decade of the grid and a half
enum { SHORTER_MOST = 15 };

// the tolerance of the reference, over the case's: its samples are few, so that it costs little
static const double TIGHTER = 0.01;

static const RunWatch NOBODY = {NULL, NULL};

// The world as a solver for run_motion, which looks at the ends of steps alone.
typedef struct Stepping {
    LibraryWorld world;
    Motion *before; // owned; at the start of the last step
} Stepping;

static void close_world(void *state)
{
    Stepping *stepping = state;
    library_world_close(&stepping->world);
    free(stepping->before);
    free(stepping);
}

static bool open_world(const Scenario *scenario, void **state, Err *err)
{
    Stepping *stepping = calloc(1, sizeof *stepping);
    assert(stepping != NULL);
    if (!library_world_open(scenario, &stepping->world, err)) {
        free(stepping);
        return false;
    }
    stepping->before = calloc(scenario->linkage.body_count, sizeof *stepping->before);
    assert(stepping->before != NULL);
    *state = stepping;
    return true;
}

static bool stride(void *state, double stop_s, double *end_s, Err *err)
{
    (void)stop_s;
    Stepping *stepping = state;
    library_world_motions(&stepping->world, stepping->before);
    if (!library_world_step(&stepping->world, err)) {
        return false;
    }
    *end_s = (double)stepping->world.steps * stepping->world.scenario->run.step;
    return true;
}

static void glance(const void *state, double time_s, Sample *sample)
{
    const Stepping *stepping = state;
    const Scenario *scenario = stepping->world.scenario;
    const double middle_s = ((double)stepping->world.steps - 0.5) * scenario->run.step;
    if (time_s < middle_s) {
        memcpy(sample->bodies, stepping->before,
               scenario->linkage.body_count * sizeof *sample->bodies);
    } else {
        library_world_motions(&stepping->world, sample->bodies);
    }
}

static const Solver LIBRARY = {
    .name = "libjointplay",
    .open = open_world,
    .stride = stride,
    .glance = glance,
    .close = close_world,
};

typedef struct Measuring {
    const TuneSearch *search;
    const Scenario *scenario; // with the setting
    bool may_shorten;
    bool is_begun;
    TuneProgram *program;
} Measuring;

// The error of the program at a step, NAN where it has none, with the reason.
static double measure(const Measuring *measuring, double step_s, TuneProgram *program)
{
    const Tune *tune = measuring->search->tune;
    Scenario printed = *measuring->scenario;
    printed.run.step = step_s;
    printed.run.interval = tune_world_every(&printed) * step_s;
    LadderRun run = {.kind = LADDER_ERROR};
    Trajectory *own = run_motion(&printed, &LIBRARY, NOBODY);
    printed.reference.tolerance = TIGHTER * options_reference_tolerance(&printed.reference);
    Trajectory *truth = run_motion(&printed, registry_solver(BACKEND_REFERENCE), NOBODY);
    const Trajectory *failed = !own->is_complete ? own : truth;
    run.is_complete = own->is_complete && truth->is_complete;
    snprintf(run.message, sizeof run.message, "%.*s", LADDER_MESSAGE_SIZE - 1, failed->message);
    if (run.is_complete) {
        run.error =
            error_against(own, truth, tune->truth.is_limited ? tune->truth.horizon_s : INFINITY);
    }
    trajectory_destroy(truth);
    trajectory_destroy(own);
    return tune_error(tune, &run, program->reason);
}

static bool is_met(const Tune *tune, double error)
{
    return error + tune->truth.uncertainty <= tune->target;
}

// In the child: coarse to fine, until the target is met.
static void work(const void *context, void *result)
{
    const Measuring *measuring = context;
    const Tune *tune = measuring->search->tune;
    TuneProgram *program = result;
    *program = *measuring->program;
    const double first_s = program->step_s;
    program->error_first = program->error = measure(measuring, first_s, program);
    program->meets = is_met(tune, program->error);
    if (!measuring->may_shorten) {
        return;
    }
    int index = tune_index_below(first_s);
    index += tune_value(index) < first_s ? 0 : 1;
    for (int i = 0; i < SHORTER_MOST && !program->meets; i++, index++) {
        const double error = measure(measuring, tune_value(index), program);
        program->meets = is_met(tune, error);
        if (program->meets || isnan(program->error) || error < program->error) {
            program->step_s = tune_value(index);
            program->error = error;
        }
    }
}

static bool next(void *owner, size_t *number, const void **context)
{
    Measuring *measuring = owner;
    const bool is_first = !measuring->is_begun;
    measuring->is_begun = true;
    *number = 0;
    *context = measuring;
    return is_first;
}

static bool take(void *owner, size_t number, const void *result, const Child *child, Err *err)
{
    (void)number;
    (void)err;
    const Measuring *measuring = owner;
    TuneProgram *program = measuring->program;
    if (child->end == CHILD_DONE) {
        *program = *(const TuneProgram *)result;
        return true;
    }
    char words[CHILD_TEXT_SIZE];
    child_describe(child, words);
    snprintf(program->reason, sizeof program->reason, "its process %s", words);
    return true;
}

static bool wait(void *owner)
{
    const TuneSearch *search = ((const Measuring *)owner)->search;
    search->wait("running the program of --code", INFINITY, search->context);
    return true;
}

bool tune_program_run(const TuneSearch *search, const Scenario *scenario, bool may_shorten,
                      Err *err)
{
    TuneProgram *program = &search->tune->program;
    *program = (TuneProgram){.is_asked = true,
                             .is_run = true,
                             .step_first_s = scenario->run.step,
                             .step_s = scenario->run.step,
                             .error_first = NAN,
                             .error = NAN};
    Measuring measuring = {
        .search = search, .scenario = scenario, .may_shorten = may_shorten, .program = program};
    const Pool pool = {
        .jobs = 1,
        .work = work,
        .result_size = sizeof(TuneProgram),
        .limits = {.time_s = (1 + SHORTER_MOST) * search->time_limit_s,
                   .memory_bytes = TASK_MEMORY_LIMIT},
        .next = next,
        .take = take,
        .wait = wait,
        .owner = &measuring,
    };
    return pool_run(&pool, err);
}

// Makes the runs of a search side by side, and those of all schemes at one step.
#include "commands/tune/tune_runs.h"
#include "base/clock.h"
#include "measure/child.h"
#include "measure/mapping_contact.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

typedef struct Making {
    const TuneSearch *search;
    const TuneRuns *runs;
    size_t begun;
    size_t taken;
    double started_s; // by the clock
    Task task;        // that is about to begin
} Making;

static bool tune_runs_next(void *owner, size_t *number, const void **context)
{
    Making *making = owner;
    const TuneRuns *runs = making->runs;
    if (runs->choose != NULL ? !runs->choose(runs->owner, number) : making->begun == runs->count) {
        return false;
    }
    *number = runs->choose != NULL ? *number : making->begun;
    making->begun++;
    making->task = (Task){.scenario = *making->search->scenario,
                          .backend = runs->is_reference ? BACKEND_REFERENCE : BACKEND_ODE,
                          .run.kind = runs->is_timing ? LADDER_TIMING : LADDER_ERROR,
                          .truth = making->search->truth};
    runs->apply(runs->owner, *number, &making->task.scenario);
    *context = &making->task;
    return true;
}

static bool tune_runs_take(void *owner, size_t number, const void *result, const Child *child,
                           Err *err)
{
    (void)err;
    Making *making = owner;
    making->taken++;
    const TuneRuns *runs = making->runs;
    const LadderRun asked = {.kind = runs->is_timing ? LADDER_TIMING : LADDER_ERROR};
    const LadderRun run = task_run(asked, result, child);
    runs->take(runs->owner, number, &run);
    return true;
}

// Of runs with a count from those of them that are over.
static double tune_runs_time_left(const Making *making)
{
    const TuneRuns *runs = making->runs;
    if (runs->choose != NULL) {
        return runs->left != NULL ? runs->left(runs->owner) / (double)making->search->jobs
                                  : INFINITY;
    }
    if (making->taken == 0) {
        return INFINITY;
    }
    return (clock_now_s() - making->started_s) * (double)(runs->count - making->taken) /
           (double)making->taken;
}

static bool tune_runs_wait(void *owner)
{
    const Making *making = owner;
    making->search->wait(making->runs->doing, tune_runs_time_left(making), making->search->context);
    return true;
}

bool tune_runs_make(const TuneSearch *search, const TuneRuns *runs, Err *err)
{
    Making *making = calloc(1, sizeof *making);
    assert(making != NULL);
    *making = (Making){.search = search, .runs = runs, .started_s = clock_now_s()};
    const Pool pool = {
        .jobs = runs->is_timing ? 1 : search->jobs,
        .work = task_measure,
        .result_size = sizeof(LadderRun),
        .limits = {.time_s = search->time_limit_s, .memory_bytes = TASK_MEMORY_LIMIT},
        .next = tune_runs_next,
        .take = tune_runs_take,
        .wait = tune_runs_wait,
        .owner = making,
    };
    const bool is_done = pool_run(&pool, err);
    free(making);
    return is_done;
}

// What can be had at a step that cannot be changed.
//
// Every scheme is run once at the step. Constants, one kp and kd or one ERP and CFM for all depths,
// are those that are best for a single impact (measure/constants.h): for the median mass and
// closing speed of the reference's contacts, as `map` has them, and for the hardest impact. What
// they are worth in the whole mechanism is not derived but run.

static void tune_runs_apply_scheme(void *owner, size_t number, Scenario *scenario)
{
    const Tune *tune = owner;
    tune_apply(&tune->schemes[number], tune->held_s, scenario);
}

static void take_scheme(void *tune, size_t number, const LadderRun *run)
{
    tune_take_held(tune, number, run);
}

bool tune_held_run(const TuneSearch *search, Err *err)
{
    const TuneRuns runs = {"running all schemes at the step", search->tune->scheme_count,
                           tune_runs_apply_scheme, take_scheme, .owner = search->tune};
    return tune_runs_make(search, &runs, err);
}

static void watch_run(double share, double wall_s, void *context)
{
    (void)share;
    (void)wall_s;
    const TuneSearch *search = context;
    search->wait("measuring the contacts", INFINITY, search->context);
}

static void tune_runs_add_settings(Tune *tune, TuneLinearSource source, const Constants *held)
{
    for (size_t i = 0; i < CONSTANTS_MAP_COUNT; i++) {
        const ConstantsSetting *setting = &held->settings[i];
        if (setting->map == ODE_MAP_MIDPOINT) {
            continue; // its row follows the closing speed: no constants
        }
        assert(tune->linear_count < TUNE_LINEAR_MAX);
        tune->linears[tune->linear_count++] = (TuneLinear){
            .source = source,
            .is_row = setting->map == ODE_MAP_CORRECTED,
            .row = setting->row,
            .depth = NAN,
            .stiffness = setting->stiffness,
            .damping = setting->damping,
            .step_s = held->step_s,
        };
    }
}

static void add_impact(const TuneSearch *search, const MappingJoint *joint, double mass,
                       double speed, TuneLinearSource source)
{
    Err ignored = {ERR_NONE, ""}; // a law need not have such an impact
    MappingContact *contact = malloc(sizeof *contact);
    Constants *held = malloc(sizeof *held);
    assert(contact != NULL && held != NULL);
    const double closing = fmax(speed, search->scenario->contact.impact_speed_floor);
    if (mass > 0.0 && closing > 0.0 &&
        mapping_contact_make(search->scenario, joint, mass, closing, contact, &ignored)) {
        search->wait("finding constants for the step", INFINITY, search->context);
        constants_find(contact, search->tune->held_s, held);
        tune_runs_add_settings(search->tune, source, held);
    }
    free(held);
    free(contact);
}

bool tune_held_constants(const TuneSearch *search, Err *err)
{
    const TuneContact *contact = &search->tune->contact;
    MappingJoint *joints = NULL;
    size_t count = 0;
    const RunWatch watch = {watch_run, (void *)search};
    if (!mapping_joint_measure(search->scenario, watch, &joints, &count, err)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        const MappingJoint *joint = &joints[i];
        if (joint->joint == (int)contact->joint) {
            add_impact(search, joint, joint->mass_median, joint->speed_median, TUNE_LINEAR_MEDIAN);
            add_impact(search, joint, contact->mass, contact->speed, TUNE_LINEAR_HARDEST);
        }
    }
    free(joints);
    return true;
}

// Does the pieces of a step of ODE one after the other, in the thread that steps the world.
//
// A job may start when none of the jobs that it waits for is left. Of those that may, the last one
// posted goes first, as in ODE's own implementation for a single thread: the order of islands, from
// which the quick solver draws its random numbers, is the same. A job that has run is over when
// what it has posted for itself to wait for is over, too; then the job that waits for it waits for
// one less. A failure is passed on to it.
#include "ode/jobs.h"

#include "base/zeroed.h"

#include <stdbool.h>
#include <stdlib.h>

typedef struct Job {
    struct Job *next; // waiting, or free
    struct Job *made; // the one made before it
    bool is_waiting;  // in the list
    size_t left;      // jobs that it waits for, and itself while it runs
    struct Job *dependent;
    int *fault_at; // NULL: nobody asks
    int fault;
    dThreadedCallFunction *work;
    void *context;
    dcallindex_t index;
} Job;

struct Jobs {
    Job *waiting;
    Job *free;
    Job *made;
};

// There is nothing to lock or to wait at: ODE holds the jobs themselves for it.
static dMutexGroupID make_locks(dThreadingImplementationID impl, dmutexindex_t count,
                                const char *const *names)
{
    (void)count, (void)names;
    return (dMutexGroupID)impl;
}

static void free_locks(dThreadingImplementationID impl, dMutexGroupID locks)
{
    (void)impl, (void)locks;
}

static void lock(dThreadingImplementationID impl, dMutexGroupID locks, dmutexindex_t index)
{
    (void)impl, (void)locks, (void)index;
}

static dCallWaitID make_wait(dThreadingImplementationID impl)
{
    return (dCallWaitID)impl;
}

static void end_wait(dThreadingImplementationID impl, dCallWaitID wait)
{
    (void)impl, (void)wait;
}

static void give_back(Jobs *jobs, Job *job)
{
    job->next = jobs->free;
    jobs->free = job;
}

static Job *take_free(Jobs *jobs)
{
    Job *job = jobs->free;
    if (job != NULL) {
        jobs->free = job->next;
        return job;
    }
    job = zeroed(1, sizeof *job);
    job->made = jobs->made;
    jobs->made = job;
    return job;
}

static void post(dThreadingImplementationID impl, int *fault_at, dCallReleaseeID *posted,
                 ddependencycount_t left, dCallReleaseeID dependent, dCallWaitID wait,
                 dThreadedCallFunction *work, void *context, dcallindex_t index, const char *name)
{
    (void)wait, (void)name;
    Jobs *jobs = (Jobs *)impl;
    Job *job = take_free(jobs);
    job->is_waiting = true;
    job->left = left;
    job->dependent = (Job *)dependent;
    job->fault_at = fault_at;
    job->fault = 0;
    job->work = work;
    job->context = context;
    job->index = index;
    job->next = jobs->waiting;
    jobs->waiting = job;
    if (posted != NULL) {
        *posted = (dCallReleaseeID)job;
    }
}

static void alter(dThreadingImplementationID impl, dCallReleaseeID of, ddependencychange_t change)
{
    (void)impl;
    ((Job *)of)->left += (size_t)change;
}

// The next job that may start, out of the list; NULL where there is none.
static Job *take_ready(Jobs *jobs)
{
    Job **link = &jobs->waiting;
    while (*link != NULL && (*link)->left != 0) {
        link = &(*link)->next;
    }
    Job *job = *link;
    if (job != NULL) {
        *link = job->next;
        job->is_waiting = false;
        job->left = 1;
    }
    return job;
}

// One thing less that a job waits for; and so on with the job that waits for it, if that was all.
static void release(Jobs *jobs, Job *job)
{
    while (--job->left == 0 && !job->is_waiting) {
        Job *dependent = job->dependent;
        const int fault = job->fault;
        if (job->fault_at != NULL) {
            *job->fault_at = fault;
        }
        give_back(jobs, job);
        if (dependent == NULL) {
            return;
        }
        dependent->fault |= fault;
        job = dependent;
    }
}

static void do_all(dThreadingImplementationID impl, int *is_over, dCallWaitID wait,
                   const dThreadedWaitTime *most, const char *name)
{
    (void)wait, (void)most, (void)name;
    Jobs *jobs = (Jobs *)impl;
    for (Job *job = take_ready(jobs); job != NULL; job = take_ready(jobs)) {
        if (job->work(job->context, job->index, (dCallReleaseeID)job) == 0) {
            job->fault = 1;
        }
        release(jobs, job);
    }
    if (is_over != NULL) {
        *is_over = 1;
    }
}

static unsigned count_threads(dThreadingImplementationID impl)
{
    (void)impl;
    return 0; // none beside the one that steps the world
}

// ODE asks for room before each step.
static int begin_jobs(dThreadingImplementationID impl, ddependencycount_t most)
{
    (void)most;
    Jobs *jobs = (Jobs *)impl;
    if (jobs->waiting != NULL) {
        // of a step that was left
        jobs->waiting = NULL;
        jobs->free = NULL;
        for (Job *job = jobs->made; job != NULL; job = job->made) {
            give_back(jobs, job);
        }
    }
    return 1;
}

Jobs *jobs_make(dWorldID world)
{
    static const dThreadingFunctionsInfo FUNCTIONS = {
        .struct_size = sizeof FUNCTIONS,
        .alloc_mutex_group = make_locks,
        .free_mutex_group = free_locks,
        .lock_group_mutex = lock,
        .unlock_group_mutex = lock,
        .alloc_call_wait = make_wait,
        .reset_call_wait = end_wait,
        .free_call_wait = end_wait,
        .post_call = post,
        .alter_call_dependencies_count = alter,
        .wait_call = do_all,
        .retrieve_thread_count = count_threads,
        .preallocate_resources_for_calls = begin_jobs,
    };
    Jobs *jobs = zeroed(1, sizeof *jobs);
    dWorldSetStepThreadingImplementation(world, &FUNCTIONS, (dThreadingImplementationID)jobs);
    return jobs;
}

void jobs_free(Jobs *jobs)
{
    if (jobs == NULL) {
        return;
    }
    while (jobs->made != NULL) {
        Job *job = jobs->made;
        jobs->made = job->made;
        free(job);
    }
    free(jobs);
}

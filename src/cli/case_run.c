// What do the backends of one case make of it, and how far are they apart?
#include "cli/case_run.h"

#include "cli/progress.h"
#include "run/registry.h"

#include <stdio.h>
#include <string.h>

// The run that the others are held against: the closed form, where it is among them.
static const Trajectory *find_truth(const CaseRun *run)
{
    for (size_t i = 0; i < run->scenario.run.backend_count; i++) {
        if (run->scenario.run.backends[i] == BACKEND_ANALYTIC && run->runs[i]->is_complete) {
            return run->runs[i];
        }
    }
    return NULL;
}

static void measure_errors(CaseRun *run)
{
    const Trajectory *truth = find_truth(run);
    for (size_t i = 0; truth != NULL && i < run->scenario.run.backend_count; i++) {
        if (run->runs[i] != truth && run->runs[i]->is_complete) {
            run->errors[i] = error_against(run->runs[i], truth);
        }
    }
}

// What the closed form has to say beyond its trajectory, where it took part.
static void ask_closed_form(CaseRun *run)
{
    const Scenario *scenario = &run->scenario;
    if (find_truth(run) == NULL || !scenario->has_fourbar) {
        return;
    }
    // a crank that does not turn fully has no turn to sum up: no error, only nothing to say
    Err err = {0};
    if (summary_compute(scenario, &run->summary, &err)) {
        run->report.summary = &run->summary;
    }
    err = (Err){0};
    if (stackup_compute(scenario, &run->stackup, &err)) {
        run->report.stackup = &run->stackup;
    }
}

void case_run_execute(CaseRun *run, bool is_quiet)
{
    const RunOptions *options = &run->scenario.run;
    for (size_t i = 0; i < options->backend_count; i++) {
        const Solver *solver = registry_solver(options->backends[i]);
        Progress progress;
        const RunWatch watch = progress_watch(&progress, solver->name, is_quiet);
        run->runs[i] = run_scenario(&run->scenario, solver, watch);
        progress_end(&progress);
        run->failed_count += run->runs[i]->is_complete ? 0 : 1;
    }
    run->report = (RunReport){
        .scenario = &run->scenario,
        .run_count = options->backend_count,
        .runs = run->runs,
        .errors = run->errors,
    };
    measure_errors(run);
    ask_closed_form(run);
}

void case_run_finish(CaseRun *run)
{
    for (size_t i = 0; i < BACKEND_COUNT; i++) {
        trajectory_destroy(run->runs[i]);
        run->runs[i] = NULL;
    }
}

void case_run_name(const Scenario *scenario, char *name, size_t size)
{
    const char *slash = strrchr(scenario->path, '/');
    const char *base = slash == NULL ? scenario->path : slash + 1;
    const char *dot = strrchr(base, '.');
    const size_t length = dot == NULL || dot == base ? strlen(base) : (size_t)(dot - base);
    snprintf(name, size, "%.*s", (int)length, base);
}

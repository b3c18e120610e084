// How does speed stand against error, over every scheme and a ladder of steps?
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/results.h"
#include "cli/warnings.h"
#include "commands/commands.h"
#include "commands/compare/compare_options.h"
#include "commands/compare/compare_progress.h"
#include "commands/compare/compare_report.h"
#include "commands/compare/compare_store.h"

#include <assert.h>
#include <stdlib.h>

// The store keeps, the progress watches.
typedef struct Listening {
    CompareStore store;
    CompareProgress progress;
} Listening;

static bool keep_truth(const LadderTruth *truth, void *context, Err *err)
{
    return compare_store_keep_truth(truth, &((Listening *)context)->store, err);
}

static bool keep_run(const LadderRun *run, void *context, Err *err)
{
    return compare_store_keep_run(run, &((Listening *)context)->store, err);
}

static bool keep_ensemble(size_t scheme, const LadderEnsemble *ensemble, void *context, Err *err)
{
    return compare_store_keep_ensemble(scheme, ensemble, &((Listening *)context)->store, err);
}

static void wait(const char *doing, void *context)
{
    compare_progress_show(&((Listening *)context)->progress, doing);
}

static bool should_stop(void *context)
{
    (void)context;
    return interrupt_number() != 0;
}

// Ends by the signal that stopped the work.
static void end_stopped(const CompareOptions *options, const Ladder *ladder, CompareStore *store)
{
    if (!options->common.is_quiet) {
        output_say("stopped; %zu of %zu runs are kept in %s, and the same command%s goes on from "
                   "there\n",
                   ladder_run_done(ladder), ladder_run_total(ladder), store->journal.path,
                   options->is_fresh ? " without --fresh" : "");
    }
    compare_store_close(store);
    interrupt_obey();
}

static const ResultFile FILES[] = {
    {.ending = ".txt", .kind = FILE_REPORT},
    {"--csv", offsetof(CompareOptions, csv), ".csv", FILE_TABLE, .write = compare_rows_write_csv},
    {"--plot", offsetof(CompareOptions, plot), ".svg", FILE_PICTURE, .text = compare_plot_write},
    {.ending = ".json", .kind = FILE_RESULT},
};

static const Results RESULTS = {
    .suffix = "-compare",
    .is_followed = true,
    .json = compare_json_build,
    .text = compare_text_write,
    RESULT_FILES(FILES),
};

// A point that fails is a result; a comparison in which every one of ODE's fails is none.
static bool check_points(const Ladder *ladder, Err *err)
{
    const LadderPoint *failed = NULL;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->step_s > 0.0 && !point->is_failed) {
            return true;
        }
        failed = point->step_s > 0.0 && failed == NULL ? point : failed;
    }
    return failed == NULL || err_set(err, ERR_SOLVER, "every run of ODE failed: %s at %.4g us: %s",
                                     failed->name, 1e6 * failed->step_s, failed->reason);
}

static bool compare_ladder(const CompareOptions *options, const Scenario *scenario, Ladder *ladder,
                           Err *err)
{
    Listening listening = {
        .progress = compare_progress_start(ladder, options->common.jobs, options->common.is_quiet)};
    const Runner runner = {
        .ladder = ladder,
        .scenario = scenario,
        .jobs = options->common.jobs,
        .time_limit_s = options->common.time_limit_s,
        .listener = {keep_truth, keep_run, keep_ensemble, wait, should_stop, &listening},
    };
    interrupt_watch();
    const bool is_run = compare_store_open(&listening.store, options, scenario, ladder, err) &&
                        runner_execute(&runner, err);
    compare_progress_end(&listening.progress);
    if (!is_run && interrupt_number() != 0) {
        end_stopped(options, ladder, &listening.store);
    }
    compare_store_close(&listening.store);
    if (!is_run) {
        return false;
    }
    ladder_conclude(ladder);
    const CompareReport report = {scenario, ladder, listening.store.machine};
    results_print(&RESULTS, &options->common, &report);
    return results_write(&RESULTS, &options->common, scenario_path(scenario), &report, err) &&
           check_points(ladder, err);
}

// Warns of the settings that no scheme and no truth makes use of.
static void warn(const CompareOptions *options, const Scenario *scenario)
{
    // a comparison runs all backends and both solvers of ODE, whatever the case says
    Scenario *whole = malloc(sizeof *whole);
    assert(whole != NULL);
    *whole = *scenario;
    whole->run.backend_count = BACKEND_COUNT;
    for (int i = 0; i < BACKEND_COUNT; i++) {
        whole->run.backends[i] = (BackendKind)i;
    }
    whole->ode.solver = ODE_QUICK;
    warnings_say(whole, &options->common);
    free(whole);
}

static bool compare_case(void *target, Err *err)
{
    const CompareOptions *options = target;
    Ladder *ladder = NULL;
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    bool is_done = common_options_load(&options->common, scenario, err) &&
                   compare_options_ladder(options, scenario, &ladder, err) &&
                   results_claim(&RESULTS, &options->common, scenario_path(scenario), err);
    if (is_done) {
        warn(options, scenario);
        is_done = compare_ladder(options, scenario, ladder, err);
    }
    ladder_destroy(ladder);
    scenario_destroy(scenario);
    return is_done;
}

static bool compare_run(int argc, char **argv, Err *err)
{
    CompareOptions options = compare_options_default();
    return arguments_run(&COMPARE_ARGUMENTS, argc, argv, &options, compare_case, err);
}

const Command cmd_compare = {
    .name = "compare",
    .summary = "speed against error: every scheme over a ladder of steps",
    .run = compare_run,
};

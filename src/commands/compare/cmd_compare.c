// How does speed stand against error, over every scheme and a ladder of steps?
#include "cli/doubts.h"
#include "cli/idle_settings.h"
#include "cli/output.h"
#include "commands/commands.h"
#include "commands/compare/compare_files.h"
#include "commands/compare/compare_json.h"
#include "commands/compare/compare_options.h"
#include "commands/compare/compare_progress.h"
#include "commands/compare/compare_store.h"
#include "commands/compare/compare_text.h"
#include "write/file.h"
#include "write/json_value.h"

#include <assert.h>
#include <stdio.h>
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

static void print_report(const CompareReport *report, const CommonOptions *options)
{
    if (options->is_json) {
        output_json(compare_json_build(report));
        return;
    }
    Text text;
    text_init(&text);
    const Style style = output_style(stdout, options->is_wide);
    compare_text_write(report, &style, &text);
    text_append(&text, "\n");
    output_text(&text, &style);
    text_finish(&text);
}

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
    return failed == NULL ||
           err_set(err, ERR_SOLVER, "every run of ODE failed: %s at %.4g us: %s",
                   ladder->schemes[failed->scheme].name, 1e6 * failed->step_s, failed->reason);
}

static bool compare_ladder(const CompareOptions *options, const Scenario *scenario, Ladder *ladder,
                           Err *err)
{
    Listening listening = {.progress = compare_progress_start(ladder, options->common.is_quiet)};
    const Runner runner = {
        .ladder = ladder,
        .scenario = scenario,
        .jobs = options->common.jobs,
        .time_limit_s = options->common.time_limit_s,
        .listener = {keep_truth, keep_run, keep_ensemble, wait, &listening},
    };
    const bool is_run = compare_store_open(&listening.store, options, scenario, ladder, err) &&
                        runner_execute(&runner, err);
    compare_progress_end(&listening.progress);
    compare_store_close(&listening.store);
    if (!is_run) {
        return false;
    }
    ladder_conclude(ladder);
    const CompareReport report = {scenario, ladder, listening.store.machine};
    print_report(&report, &options->common);
    return compare_files_write(&report, options, err) && check_points(ladder, err);
}

// Names the settings of the command line that no scheme and no truth makes use of.
static void say_idle(const CompareOptions *options, const Scenario *scenario)
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
    doubts_say(whole);
    idle_settings_say(whole, options->common.overrides, options->common.override_count);
    free(whole);
}

static bool compare_case(const CompareOptions *options, Scenario *scenario, Err *err)
{
    Ladder *ladder = NULL;
    bool is_done =
        common_options_load(&options->common, scenario, err) &&
        compare_options_ladder(options, scenario, &ladder, err) &&
        (options->common.folder == NULL || file_make_folder(options->common.folder, err)) &&
        compare_files_claim(scenario, options, err);
    if (is_done && !options->common.is_quiet) {
        say_idle(options, scenario);
    }
    is_done = is_done && compare_ladder(options, scenario, ladder, err);
    ladder_destroy(ladder);
    return is_done;
}

static bool compare_run(int argc, char **argv, Err *err)
{
    CompareOptions options;
    bool is_answered;
    if (!compare_options_read(argc, argv, &options, &is_answered, err) || is_answered) {
        return err->kind == ERR_NONE;
    }
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    const bool is_done = compare_case(&options, scenario, err);
    free(scenario);
    return is_done;
}

const Command cmd_compare = {
    .name = "compare",
    .summary = "speed against error: every scheme over a ladder of steps",
    .run = compare_run,
};

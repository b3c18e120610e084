// Which setting of ODE is the cheapest that is accurate enough?
#include "base/clock.h"
#include "cli/doubts.h"
#include "cli/idle_settings.h"
#include "cli/output.h"
#include "cli/status_line.h"
#include "commands/commands.h"
#include "commands/tune/tune_files.h"
#include "commands/tune/tune_held_text.h"
#include "commands/tune/tune_json.h"
#include "commands/tune/tune_options.h"
#include "commands/tune/tune_search.h"
#include "commands/tune/tune_setting.h"
#include "commands/tune/tune_text.h"
#include "write/file.h"
#include "write/units.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// How far the search has come, on standard error.
typedef struct Watching {
    const Tune *tune;
    StatusLine line;
    double started_s; // by the clock
} Watching;

static void wait(const char *doing, void *context)
{
    Watching *watching = context;
    const double wall_s = clock_now_s() - watching->started_s;
    if (status_line_is_due(&watching->line, wall_s)) {
        char words[128];
        snprintf(words, sizeof words, "%s: %zu settings run, %.0f s", doing,
                 watching->tune->trial_count, wall_s);
        status_line_show(&watching->line, words);
    }
}

static void print_report(const TuneReport *report, const CommonOptions *options)
{
    if (options->is_json) {
        output_json(tune_json_build(report));
        return;
    }
    Text text;
    text_init(&text);
    const Style style = output_style(stdout, options->is_wide);
    tune_text_write(report, &style, &text);
    output_text(&text, &style);
    text_finish(&text);
}

// That nothing meets the error is a result, with a status of its own.
static bool check_met(const TuneReport *report, Err *err)
{
    const Tune *tune = report->tune;
    const TuneTrial *best = tune_best(tune, tune->winner);
    if (tune_report_is_met(report)) {
        return true;
    }
    if (tune->held_s > 0.0) {
        return tune_held_text_unmet(report, err);
    }
    if (best == NULL) {
        return err_set(err, ERR_DIFFERS, "no setting that was tried meets an error of %.3g",
                       tune->target);
    }
    return err_set(err, ERR_DIFFERS,
                   "no setting within --max-cost meets an error of %.3g: the cheapest that does "
                   "takes %zu steps and %.3g ms",
                   tune->target, best->run.steps,
                   tune->schemes[best->scheme].processor_median_s * UNITS_MS);
}

static bool search(const TuneOptions *options, const Scenario *scenario, Tune *tune, Err *err)
{
    Watching watching = {.tune = tune,
                         .line = status_line_start(options->common.is_quiet),
                         .started_s = clock_now_s()};
    const TuneSearch work = {
        .tune = tune,
        .scenario = scenario,
        .jobs = options->common.jobs,
        .time_limit_s = options->common.time_limit_s,
        .wait = wait,
        .context = &watching,
    };
    const bool is_done = tune_search_execute(&work, err);
    status_line_end(&watching.line);
    return is_done;
}

// Names the settings of the command line that have no effect: those that nothing makes use of, and
// those that are what is searched for.
static void say_idle(const TuneOptions *options, const Scenario *scenario)
{
    Scenario *whole = malloc(sizeof *whole);
    assert(whole != NULL);
    *whole = *scenario;
    // the search tries both solvers, whatever the case says
    whole->ode.solver = ODE_QUICK;
    doubts_say(whole);
    idle_settings_say(whole, options->common.overrides, options->common.override_count);
    free(whole);
    for (size_t i = 0; i < options->common.override_count; i++) {
        if (tune_setting_replaces(options->common.overrides[i])) {
            const char *given = options->common.overrides[i];
            output_say("without effect: %.*s (it is what tune searches for)\n",
                       (int)strcspn(given, "="), given);
        }
    }
}

static bool tune_case(const TuneOptions *options, Scenario *scenario, Err *err)
{
    Tune *tune = NULL;
    bool is_done =
        common_options_load(&options->common, scenario, err) &&
        tune_options_search(options, scenario, &tune, err) &&
        (options->common.folder == NULL || file_make_folder(options->common.folder, err)) &&
        tune_files_claim(scenario, options, err);
    if (is_done && !options->common.is_quiet) {
        say_idle(options, scenario);
    }
    is_done = is_done && search(options, scenario, tune, err);
    if (is_done) {
        const TuneReport report = {scenario, tune, options->common.overrides,
                                   options->common.override_count, options->common.time_limit_s};
        print_report(&report, &options->common);
        is_done = tune_files_write(&report, options, err) && check_met(&report, err);
    }
    tune_destroy(tune);
    return is_done;
}

static bool tune_run(int argc, char **argv, Err *err)
{
    TuneOptions options;
    bool is_answered;
    if (!tune_options_read(argc, argv, &options, &is_answered, err) || is_answered) {
        return err->kind == ERR_NONE;
    }
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    const bool is_done = tune_case(&options, scenario, err);
    free(scenario);
    return is_done;
}

const Command cmd_tune = {
    .name = "tune",
    .summary = "the cheapest setting that meets an error, checked by running it",
    .run = tune_run,
};

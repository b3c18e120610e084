// Which setting of ODE is the cheapest that is accurate enough?
#include "cli/output.h"
#include "cli/results.h"
#include "cli/status_line.h"
#include "cli/warnings.h"
#include "commands/commands.h"
#include "commands/tune/tune_export.h"
#include "commands/tune/tune_limit.h"
#include "commands/tune/tune_linear.h"
#include "commands/tune/tune_options.h"
#include "commands/tune/tune_program.h"
#include "commands/tune/tune_report.h"
#include "commands/tune/tune_search.h"
#include "commands/tune/tune_setting.h"
#include "write/units.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// How far the search has come, on standard error.
typedef struct Watching {
    const Tune *tune;
    StatusLine line;
} Watching;

static void wait(const char *doing, double left_s, void *context)
{
    Watching *watching = context;
    const double wall_s = status_line_time(&watching->line);
    if (!status_line_is_due(&watching->line, wall_s, left_s)) {
        return;
    }
    Text words;
    text_init(&words);
    text_append(&words, "%s: %zu settings run, %.0f s", doing, watching->tune->trial_count, wall_s);
    status_line_append_left(&words, left_s);
    status_line_show(&watching->line, words.data);
    text_finish(&words);
}

// Whether there is a contact to write; where there is none, why.
static bool has_contact(const TuneReport *report, bool is_found, const char *reason,
                        const char **nothing)
{
    *nothing = scenario_has_clearance(report->scenario) ? reason : "no joint of the case has play";
    return is_found;
}

// Programs are of planar cases.
static const char *program_lacks(const Scenario *scenario)
{
    return scenario->linkage.is_spatial ? "programs are written for cases in the plane alone"
                                        : NULL;
}

static bool write_code(const void *target, Text *text, const char **nothing, Err *err)
{
    const TuneReport *report = target;
    const TuneTrial *trial = tune_export_trial(report);
    *nothing = program_lacks(report->scenario);
    if (*nothing != NULL) {
        return false;
    }
    if (!has_contact(report, trial != NULL, "no run has a meaningful error", nothing)) {
        return false;
    }
    const char *lacks = tune_export_lacks(report);
    if (lacks != NULL) {
        *nothing = lacks;
        return false;
    }
    const TuneProgram *program = &report->tune->program;
    if (program->reason[0] != '\0') {
        *nothing = program->reason;
        return false;
    }
    if (tune_report_is_met(report) && !program->meets) {
        *nothing = "its error is larger than what was asked for";
        return false;
    }
    return tune_export_code(report, text, err);
}

static bool write_sdf(const void *target, Text *text, const char **nothing, Err *err)
{
    (void)err;
    const TuneReport *report = target;
    tune_gazebo_write(report, text);
    return has_contact(report, text->length > 0, tune_linear_lacks(report->scenario, report->tune),
                       nothing);
}

static bool write_mjcf(const void *target, Text *text, const char **nothing, Err *err)
{
    (void)err;
    const TuneReport *report = target;
    tune_mujoco_write(report, text);
    const TuneContact *contact = &report->tune->contact;
    const char *lacks = contact->is_limit && report->tune->linear != TUNE_NONE
                            ? tune_limit_lacks_range(report->scenario, contact->joint)
                            : NULL;
    return has_contact(report, text->length > 0,
                       lacks != NULL ? lacks : tune_linear_lacks(report->scenario, report->tune),
                       nothing);
}

static const ResultFile FILES[] = {
    {"--code", offsetof(TuneOptions, code), ".c", FILE_CODE, .may = write_code},
    {"--sdf", offsetof(TuneOptions, sdf), ".sdf", FILE_SDF, .may = write_sdf},
    {"--mjcf", offsetof(TuneOptions, mjcf), ".xml", FILE_MJCF, .may = write_mjcf},
    {.ending = ".txt", .kind = FILE_REPORT},
    {.ending = ".json", .kind = FILE_RESULT},
};

static const Results RESULTS = {
    .suffix = "-tune",
    .json = tune_json_build,
    .text = tune_text_write,
    RESULT_FILES(FILES),
};

// Refuses before the search what it cannot write, whatever it finds. --code, of which some schemes
// may be writable, is checked scheme by scheme in tune_options_search.
static bool check_files(const TuneOptions *options, const Scenario *scenario, Err *err)
{
    const struct {
        const char *option;
        const char *path;
        const char *(*lacks)(const Scenario *scenario);
    } asked[] = {
        {"--sdf", options->sdf, tune_linear_lacks_case},
        {"--mjcf", options->mjcf, tune_linear_lacks_range},
    };
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
        const char *lacks = asked[i].path != NULL ? asked[i].lacks(scenario) : NULL;
        if (lacks != NULL) {
            return err_set(err, ERR_USAGE, "%s: %s", asked[i].option, lacks);
        }
    }
    return true;
}

// Nor is a program written for an error that it does not meet.
static bool check_program(const TuneProgram *program, const Tune *tune, Err *err)
{
    if (!program->is_run || program->meets) {
        return true;
    }
    return err_set(err, ERR_DIFFERS,
                   "the program of --code, run with libjointplay, has an error of %.3g at a step "
                   "of %.3g ms, where %.3g was asked for; --schemes may name another setting",
                   program->error, program->step_s * UNITS_MS, tune->target);
}

// That nothing meets the error is a result, with a status of its own.
static bool check_met(const TuneReport *report, Err *err)
{
    const Tune *tune = report->tune;
    const TuneTrial *best = tune_best(tune, tune->winner);
    if (tune_report_is_met(report)) {
        return check_program(&tune->program, tune, err);
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

// Runs the program that is to be written, if there is one.
static bool run_program(const TuneOptions *options, const TuneSearch *work, Err *err)
{
    const CommonOptions *common = &options->common;
    const TuneReport report = {work->scenario, work->tune, common->overrides,
                               common->override_count, common->time_limit_s};
    const bool may_shorten = tune_report_is_met(&report) && work->tune->held_s == 0.0;
    const bool is_asked = options->code != NULL || common->folder != NULL;
    if (!is_asked || work->scenario->linkage.is_spatial || tune_export_trial(&report) == NULL ||
        tune_export_lacks(&report) != NULL) {
        return true;
    }
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    const bool is_done = tune_export_scenario(&report, scenario, err) &&
                         tune_program_run(work, scenario, may_shorten, err);
    free(scenario);
    return is_done;
}

static bool search(const TuneOptions *options, const Scenario *scenario, Tune *tune, Err *err)
{
    const CommonOptions *common = &options->common;
    Watching watching = {tune, status_line_start(common->is_quiet)};
    const TuneSearch work = {
        .tune = tune,
        .scenario = scenario,
        .jobs = common->jobs,
        .time_limit_s = common->time_limit_s,
        .wait = wait,
        .context = &watching,
    };
    const bool is_done = tune_search_execute(&work, err) && run_program(options, &work, err);
    status_line_end(&watching.line);
    return is_done;
}

// Names the settings of the command line that have no effect: those that nothing makes use of, and
// those that are what is searched for.
static void warn(const TuneOptions *options, const Scenario *scenario)
{
    Scenario *whole = malloc(sizeof *whole);
    assert(whole != NULL);
    *whole = *scenario;
    // the search tries both solvers beside the reference, whatever the case says
    whole->ode.solver = ODE_QUICK;
    whole->run.backend_count = BACKEND_COUNT;
    for (int i = 0; i < BACKEND_COUNT; i++) {
        whole->run.backends[i] = (BackendKind)i;
    }
    warnings_say(whole, &options->common);
    free(whole);
    for (size_t i = 0; !options->common.is_quiet && i < options->common.override_count; i++) {
        if (tune_setting_replaces(options->common.overrides[i])) {
            const char *given = options->common.overrides[i];
            output_say(
                "jointplay: warning: %.*s of the command line has no effect here; it is what "
                "tune searches for\n",
                (int)strcspn(given, "="), given);
        }
    }
}

static bool tune_case(void *target, Err *err)
{
    const TuneOptions *options = target;
    const CommonOptions *common = &options->common;
    Tune *tune = NULL;
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    bool is_done = common_options_load(common, scenario, err) &&
                   check_files(options, scenario, err) &&
                   tune_options_search(options, scenario, &tune, err) &&
                   results_claim(&RESULTS, common, scenario_path(scenario), err);
    if (is_done) {
        warn(options, scenario);
        is_done = search(options, scenario, tune, err);
    }
    if (is_done) {
        const TuneReport report = {scenario, tune, common->overrides, common->override_count,
                                   common->time_limit_s};
        results_print(&RESULTS, common, &report);
        is_done = check_met(&report, err);
        Err unwritten = {0};
        if (!results_write(&RESULTS, common, scenario_path(scenario), &report, &unwritten)) {
            // that an error is not met says why a program is not written
            is_done = err_set_lines(err, unwritten.kind, unwritten.text);
        }
    }
    tune_destroy(tune);
    scenario_destroy(scenario);
    return is_done;
}

static bool tune_run(int argc, char **argv, Err *err)
{
    TuneOptions options = tune_options_default();
    return arguments_run(&TUNE_ARGUMENTS, argc, argv, &options, tune_case, err);
}

const Command cmd_tune = {
    .name = "tune",
    .summary = "the cheapest setting that meets an error, checked by running it",
    .run = tune_run,
};

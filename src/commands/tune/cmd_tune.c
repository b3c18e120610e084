// The command `jointplay tune`: its options and its flow.
#include "base/err.h"
#include "base/shell.h"
#include "casefile/quantity.h"
#include "cli/common_options.h"
#include "cli/output.h"
#include "cli/results.h"
#include "cli/status_line.h"
#include "cli/warnings.h"
#include "commands/commands.h"
#include "commands/tune/tune.h"
#include "commands/tune/tune_engine.h"
#include "commands/tune/tune_export.h"
#include "commands/tune/tune_files.h"
#include "commands/tune/tune_linear.h"
#include "commands/tune/tune_program.h"
#include "commands/tune/tune_search.h"
#include "commands/tune/tune_world.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct TuneOptions {
    CommonOptions common;
    double error;           // 1; 0 until it is given
    const char *error_of;   // a word of OPTIONS_TOLERANCES_OF, or NULL
    double at_step_s;       // s, the only step that can be taken; 0: any
    const char *asked_cost; // of --cost, or NULL
    TuneCost cost;
    TuneLimit limit;
    const char *backend; // another engine, NAME or NAME/WAY+WAY, or NULL
    const char *code;
    const char *sdf;
    const char *mjcf;
} TuneOptions;

// The options.

// s: a slower setting is not cheap, and a search makes many runs
static const double DEFAULT_TIME_LIMIT = 60.0;

// errors of the speeds' own size are of no use
static const double ERROR_MOST = 0.5;
static const double COST_STEPS_MOST = 1e9;

static bool read_error(const char *text, void *options, Err *err)
{
    Complaint complaint;
    double value;
    if (!quantity_number(text, &value, &complaint) || !(value > 0.0) || value > ERROR_MOST) {
        return err_set(err, ERR_USAGE,
                       "--error is %s; allowed: a number above 0, up to %g, such as 1e-3", text,
                       ERROR_MOST);
    }
    ((TuneOptions *)options)->error = value;
    return true;
}

// A plain number counts world steps, a time is a time.
static bool cmd_tune_read_limit(const char *text, void *target, Err *err)
{
    TuneOptions *options = target;
    Complaint complaint;
    double time_s;
    size_t steps;
    if (quantity_integer(text, &steps, &complaint) && steps > 0 &&
        (double)steps <= COST_STEPS_MOST) {
        options->limit = (TuneLimit){.steps = steps};
        return true;
    }
    if (quantity_parse(text, DIMENSION_TIME, &time_s, &complaint) && time_s > 0.0) {
        options->limit = (TuneLimit){.time_s = time_s};
        return true;
    }
    return err_set(err, ERR_USAGE,
                   "--max-cost is %s; allowed: a time above 0 such as '50 ms', or a whole number "
                   "of world steps such as 2000",
                   text);
}

#define AT(field) .offset = offsetof(TuneOptions, field)

static const char *const COSTS[] = {"time", "steps", NULL};

static const OptionRow TUNE_OPTIONS[] = {
    {"error", "X",
     "The largest error allowed of any rate of the motion, relative to its own largest value, such "
     "as 1e-3",
     1, OPTION_READ, .read = read_error},
    {"error-of", "motion|forces|peaks",
     "Which error that is: of the motion, of the contact forces, or of the peaks of contacts and "
     "of "
     "angular accelerations (default: run.tolerance-of of the case)",
     1, OPTION_CHOICE, AT(error_of), .words = OPTIONS_TOLERANCES_OF},
    {"max-cost", "COST",
     "What one run may cost: a time such as '50 ms', or world steps such as 2000", 1, OPTION_READ,
     .read = cmd_tune_read_limit},
    {"cost", "time|steps", "What to minimise (default: time, or the unit of --max-cost)", 1,
     OPTION_CHOICE, AT(asked_cost), .words = COSTS},
    {"at-step", "TIME",
     "A step that cannot be changed, such as '1 ms': the smallest error at it, of every scheme and "
     "of contacts with constants; --error may be omitted",
     1, OPTION_QUANTITY, AT(at_step_s), .dimension = DIMENSION_TIME},
    COMMON_SCHEMES(1),
    {"backend", "NAME[/WAY]", "Search on this engine instead of ODE: mujoco, chipmunk/kernel+force",
     1, OPTION_TEXT, AT(backend)},
    COMMON_DRIVERS(1),
    COMMON_SET(1),
    COMMON_JOBS(2, "Runs at a time while searching (default: one per core); timing runs always go "
                   "one by one"),
    COMMON_TIME_LIMIT(2, "A run that takes longer is not tried (default: 60 s)"),
    {"code", "FILE.c", "Write the setting as a short C program against libjointplay", 3,
     OPTION_TEXT, AT(code)},
    {"sdf", "FILE.sdf", "Write the mechanism or the contact for Gazebo", 3, OPTION_TEXT, AT(sdf)},
    {"mjcf", "FILE.xml", "Write the contact in MuJoCo's form", 3, OPTION_TEXT, AT(mjcf)},
    COMMON_JSON(3),
    COMMON_FULL(3),
    COMMON_WIDE(3),
    COMMON_OUT(3, "Write <case>-tune.json, .txt, .c, .sdf and .xml there"),
    COMMON_QUIET(3),
};
#undef AT

// The cost that is minimized must be the one that is limited.
static bool settle_cost(TuneOptions *options, Err *err)
{
    const char *cost = options->asked_cost;
    const bool has_steps = options->limit.steps > 0;
    options->cost = has_steps ? TUNE_STEPS : TUNE_TIME;
    if (options->at_step_s > 0.0 && (has_steps || options->limit.time_s > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "--max-cost and --at-step do not go together: with a fixed step there "
                       "is no cost to choose");
    }
    if (cost == NULL) {
        return true;
    }
    const TuneCost asked = strcmp(cost, "steps") == 0 ? TUNE_STEPS : TUNE_TIME;
    const bool has_limit = options->limit.steps > 0 || options->limit.time_s > 0.0;
    if (options->at_step_s > 0.0) {
        return err_set(err, ERR_USAGE,
                       "--cost and --at-step do not go together: with a fixed step there "
                       "is no cost to choose");
    }
    if (has_limit && asked != options->cost) {
        return err_set(err, ERR_USAGE, "--cost %s and a --max-cost in %s do not go together", cost,
                       options->cost == TUNE_STEPS ? "steps" : "time");
    }
    options->cost = asked;
    return true;
}

static bool cmd_tune_check(void *target, Err *err)
{
    TuneOptions *options = target;
    if (options->common.path == NULL) {
        return err_set(err, ERR_USAGE, "no case given: jointplay tune CASE.yaml --error 1e-3");
    }
    if (options->error == 0.0 && options->at_step_s == 0.0) {
        char *path = shell_copy_path(options->common.path);
        err_set(err, ERR_USAGE, "no error given: jointplay tune %s --error 1e-3", path);
        free(path);
        return false;
    }
    return settle_cost(options, err);
}

static const Arguments TUNE_ARGUMENTS = {
    .program = "jointplay tune",
    .usage = "CASE",
    .doc = "Searches for the cheapest setting of ODE whose error, found by running it against "
           "the certified reference, meets --error, and prints it as numbers, as ODE C code, "
           "and, as far as they can express it, for Gazebo and MuJoCo, with all that was tried."
           "\vExit status 1 says that no setting meets the error, or none within --max-cost.",
    .argument = COMMON_PATH("tune takes one case"),
    OPTION_ROWS(TUNE_OPTIONS),
    .check = cmd_tune_check,
};

static TuneOptions tune_options_default(void)
{
    return (TuneOptions){.common.jobs = common_options_count_jobs(),
                         .common.time_limit_s = DEFAULT_TIME_LIMIT};
}

// What a program against libjointplay lacks for a scheme of ODE, or NULL.
static const char *tune_options_program_lacks(const Scenario *scenario, const Scheme *scheme)
{
    const char *lacks = tune_export_lacks_case(scenario);
    if (lacks != NULL) {
        return lacks;
    }
    Scenario setting = *scenario;
    scheme_apply(scheme, scenario->run.step, &setting);
    if (!scheme_has_step(scheme)) {
        // the way of stepping that a step chosen for a tolerance is for
        setting = scenario_with_step(&setting, setting.run.step);
    }
    return tune_world_lacks(&setting);
}

// Keeps the schemes that a program of --code can have, and says what it leaves out. Fails where
// none is left: nothing is searched for that cannot be written.
static bool keep_writable(const TuneOptions *options, const Scenario *scenario, Scheme *schemes,
                          size_t *count, Err *err)
{
    if (options->code == NULL) {
        return true;
    }
    if (scenario->linkage.is_spatial) {
        return err_set(err, ERR_USAGE, "--code: programs are written for cases in the plane alone");
    }
    const char *lacks = NULL;
    size_t kept = 0;
    size_t left_out = 0;
    Scheme first;
    for (size_t i = 0; i < *count; i++) {
        const char *why = schemes[i].backend == BACKEND_ODE
                              ? tune_options_program_lacks(scenario, &schemes[i])
                              : "";
        if (why == NULL) {
            schemes[kept++] = schemes[i];
        } else if (*why != '\0' && left_out++ == 0) {
            lacks = why;
            first = schemes[i];
        }
    }
    *count = kept;
    if (kept == 0) {
        return err_set(err, ERR_USAGE, "--code: %s", lacks);
    }
    if (left_out > 0 && !options->common.is_quiet) {
        output_say("left out for --code: %s%s (%s)\n", first.name,
                   left_out > 1 ? " and others" : "", lacks);
    }
    return true;
}

// Of which error the target is. Fails with ERR_USAGE where the case has none of it.
static bool settle_error(const TuneOptions *options, Scenario *scenario, Err *err)
{
    for (int i = 0; options->error_of != NULL && i < TOLERANCE_OF_COUNT; i++) {
        if (strcmp(options->error_of, OPTIONS_TOLERANCES_OF[i]) == 0) {
            scenario->run.tolerance_of = (ToleranceOf)i;
        }
    }
    return scenario->run.tolerance_of != TOLERANCE_OF_FORCES || scenario_has_clearance(scenario) ||
           err_set(err, ERR_USAGE,
                   "--error-of forces: no joint has play, and no contact a force; allowed: motion, "
                   "peaks");
}

// The search that the options ask for, with nothing run yet. Fails with ERR_USAGE for schemes that
// the case does not have, with ERR_CASE for a case in which nothing could be tuned.
static bool tune_options_search(const TuneOptions *options, const Scenario *scenario, Tune **tune,
                                Err *err)
{
    if (!scheme_check(scenario, err)) {
        return false;
    }
    if (scenario->contact.model == CONTACT_POISSON && scenario_has_clearance(scenario)) {
        return err_set(err, ERR_CASE,
                       "contact.model poisson has no spring and no reference of its own: against "
                       "the elastic law its error is that of the model, which no step removes; "
                       "allowed: contact.model impact");
    }
    const CommonOptions *common = &options->common;
    const bool is_held = options->at_step_s > 0.0;
    Scheme schemes[SCHEME_MAX];
    size_t scheme_count;
    if (!common_options_list_schemes(common, scenario, schemes, &scheme_count, err) ||
        !keep_writable(options, scenario, schemes, &scheme_count, err) ||
        (is_held && !common_options_check_step(common, options->at_step_s, err))) {
        return false;
    }
    Tune *made = tune_create(scenario, schemes, scheme_count,
                             options->error > 0.0 ? options->error : INFINITY);
    made->cost = options->cost;
    made->limit = options->limit;
    if (is_held) {
        tune_hold(made, options->at_step_s);
    }
    if (made->scheme_count == 0) {
        tune_destroy(made);
        return err_set(err, ERR_USAGE,
                       "--schemes %s chooses its steps by itself; --at-step needs one that takes "
                       "the step it is given, such as direct/plain",
                       common->schemes);
    }
    *tune = made;
    return true;
}

// How far the search has come, on standard error.
typedef struct Watching {
    const Tune *tune;
    StatusLine line;
} Watching;

static void cmd_tune_wait(const char *doing, double left_s, void *context)
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

// Whether a file is to be written, and in words why not.
static bool is_wanted(const TuneReport *report, TuneFileKind kind, const char **nothing)
{
    static char reason[ERR_TEXT_SIZE]; // the caller reads it at once
    Text words;
    text_init(&words);
    const bool is_good = tune_file_is_wanted(report, kind, &words);
    snprintf(reason, sizeof reason, "%s", words.data);
    text_finish(&words);
    *nothing = reason;
    return is_good;
}

// Programs are of planar cases.
static const char *cmd_tune_program_lacks(const Scenario *scenario)
{
    return scenario->linkage.is_spatial ? "programs are written for cases in the plane alone"
                                        : NULL;
}

static bool cmd_tune_write_code(const void *target, Text *text, const char **nothing, Err *err)
{
    const TuneReport *report = target;
    const TuneTrial *trial = tune_export_trial(report);
    *nothing = cmd_tune_program_lacks(report->scenario);
    if (*nothing != NULL) {
        return false;
    }
    if (!has_contact(report, trial != NULL, "no run has a meaningful error", nothing)) {
        return false;
    }
    const TuneProgram *program = &report->tune->program;
    if (!program->is_run) {
        *nothing = tune_export_lacks(report);
        return false;
    }
    return is_wanted(report, TUNE_FILE_CODE, nothing) && tune_export_code(report, text, err);
}

// Says what a whole model has no words for, each of which is a comment in it (docs/drivers.md).
static void say_left_out(const char *option, const char *model)
{
    static const char LEFT_OUT[] = "<!-- left out: ";
    const char *at = model;
    while (at != NULL && (at = strstr(at, LEFT_OUT)) != NULL) {
        at += strlen(LEFT_OUT);
        const char *end = strstr(at, " -->");
        output_say("jointplay: %s leaves out: %.*s\n", option, (int)(end != NULL ? end - at : 0),
                   at);
    }
}

static bool write_sdf(const void *target, Text *text, const char **nothing, Err *err)
{
    (void)err;
    const TuneReport *report = target;
    if (!is_wanted(report, TUNE_FILE_SDF, nothing)) {
        return false;
    }
    tune_gazebo_write_world(report, text);
    say_left_out("--sdf", text->data);
    return has_contact(report, text->length > 0, tune_linear_lacks(report->scenario, report->tune),
                       nothing);
}

static bool write_mjcf(const void *target, Text *text, const char **nothing, Err *err)
{
    (void)err;
    const TuneReport *report = target;
    if (!is_wanted(report, TUNE_FILE_MJCF, nothing)) {
        return false;
    }
    tune_mujoco_write(report, text);
    say_left_out("--mjcf", report->tune->model.text);
    const TuneContact *contact = &report->tune->contact;
    const char *lacks = contact->is_limit && report->tune->linear != TUNE_NONE
                            ? tune_limit_lacks_range(report->scenario, contact->joint)
                            : NULL;
    return has_contact(report, text->length > 0,
                       lacks != NULL ? lacks : tune_linear_lacks(report->scenario, report->tune),
                       nothing);
}

static const ResultFile TUNE_FILES[] = {
    {"--code", offsetof(TuneOptions, code), ".c", FILE_CODE, .may = cmd_tune_write_code},
    {"--sdf", offsetof(TuneOptions, sdf), ".sdf", FILE_SDF, .may = write_sdf},
    {"--mjcf", offsetof(TuneOptions, mjcf), ".xml", FILE_MJCF, .may = write_mjcf},
    {.ending = ".txt", .kind = FILE_REPORT},
    {.ending = ".json", .kind = FILE_RESULT},
};

static const Results TUNE_RESULTS = {
    .suffix = "-tune",
    .json = tune_json_build,
    .text = tune_text_write,
    .screen = tune_screen_write,
    RESULT_FILES(TUNE_FILES),
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

// That nothing meets the error is a result, with a status of its own.
static bool check_met(const TuneReport *report, Err *err)
{
    const Tune *tune = report->tune;
    const TuneTrial *best = tune_best(tune, tune->winner);
    if (tune_report_is_met(report)) {
        return tune_files_check(report, err);
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
static bool cmd_tune_run_program(const TuneOptions *options, const TuneSearch *work, Err *err)
{
    const CommonOptions *common = &options->common;
    const TuneReport report = {work->scenario, work->tune, common->overrides,
                               common->override_count, common->time_limit_s};
    return work->tune->asked[TUNE_FILE_CODE] == TUNE_UNASKED ||
           work->scenario->linkage.is_spatial || tune_program_run(work, &report, err);
}

// Which files are asked for, by name or in a folder.
static void take_files(const TuneOptions *options, Tune *tune)
{
    const char *const named[TUNE_FILE_COUNT] = {
        [TUNE_FILE_CODE] = options->code,
        [TUNE_FILE_SDF] = options->sdf,
        [TUNE_FILE_MJCF] = options->mjcf,
    };
    for (int kind = 0; kind < TUNE_FILE_COUNT; kind++) {
        tune->asked[kind] = named[kind] != NULL              ? TUNE_NAMED
                            : options->common.folder != NULL ? TUNE_IN_FOLDER
                                                             : TUNE_UNASKED;
    }
}

static bool search(const TuneOptions *options, const Scenario *scenario, Tune *tune, Err *err)
{
    const CommonOptions *common = &options->common;
    Watching watching = {tune, status_line_start(common->is_quiet)};
    take_files(options, tune);
    const TuneSearch work = {
        .tune = tune,
        .scenario = scenario,
        .jobs = common->jobs,
        .time_limit_s = common->time_limit_s,
        .wait = cmd_tune_wait,
        .context = &watching,
    };
    const bool is_done =
        tune_search_execute(&work, err) && cmd_tune_run_program(options, &work, err);
    status_line_end(&watching.line);
    return is_done;
}

// Names the settings of the command line that have no effect: those that nothing makes use of, and
// those that are what is searched for.
static void cmd_tune_warn(const TuneOptions *options, const Scenario *scenario)
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

// On another engine, whose settings are its ways and its step.
static bool tune_on_engine(const TuneOptions *options, Err *err)
{
    const CommonOptions *common = &options->common;
    if (options->code != NULL || options->sdf != NULL || options->mjcf != NULL ||
        common->folder != NULL || common->schemes != NULL || options->at_step_s > 0.0 ||
        options->asked_cost != NULL || options->limit.steps > 0 || options->limit.time_s > 0.0) {
        return err_set(err, ERR_USAGE,
                       "with --backend tune searches an engine's ways and steps, and prints what "
                       "it finds: no --schemes, --cost, --max-cost, --at-step, --code, --sdf, "
                       "--mjcf or --out");
    }
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    const TuneEngineOptions asked = {
        .common = common, .engine = options->backend, .target = options->error};
    const bool is_done = common_options_read(common, scenario, err) &&
                         settle_error(options, scenario, err) &&
                         tune_engine_run(&asked, scenario, err);
    scenario_destroy(scenario);
    return is_done;
}

// On ODE the one engine beside it is MuJoCo, which runs the model that is written for it.
static bool take_drivers(const CommonOptions *common, Scenario *scenario, Err *err)
{
    for (size_t i = 0; i < common->driver_count; i++) {
        const char *given = common->drivers[i];
        BackendKind backend;
        if (!common_options_take_driver(given, scenario, &backend, err)) {
            return false;
        }
        if (backend != BACKEND_MUJOCO) {
            return err_set(err, ERR_USAGE,
                           "--driver %s is not used: without --backend tune runs ODE, and MuJoCo "
                           "for --mjcf and --out",
                           given);
        }
    }
    return true;
}

static bool tune_case(void *target, Err *err)
{
    const TuneOptions *options = target;
    const CommonOptions *common = &options->common;
    if (options->backend != NULL && strcmp(options->backend, "ode") != 0) {
        return tune_on_engine(options, err);
    }
    Tune *tune = NULL;
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    bool is_done = common_options_load(common, scenario, err) &&
                   take_drivers(common, scenario, err) && settle_error(options, scenario, err) &&
                   check_files(options, scenario, err) &&
                   tune_options_search(options, scenario, &tune, err) &&
                   results_claim(&TUNE_RESULTS, common, scenario_path(scenario), err);
    if (is_done) {
        cmd_tune_warn(options, scenario);
        is_done = search(options, scenario, tune, err);
    }
    if (is_done) {
        const TuneReport report = {scenario, tune, common->overrides, common->override_count,
                                   common->time_limit_s};
        results_print(&TUNE_RESULTS, common, &report);
        is_done = check_met(&report, err);
        Err unwritten = {0};
        if (!results_write(&TUNE_RESULTS, common, scenario_path(scenario), &report, &unwritten)) {
            is_done = err_add(err, &unwritten);
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
    .arguments = &TUNE_ARGUMENTS,
};

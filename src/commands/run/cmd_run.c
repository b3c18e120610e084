// What do the backends of a case make of it?
#include "casefile/casefile.h"
#include "cli/arguments.h"
#include "cli/doubts.h"
#include "cli/idle_settings.h"
#include "cli/option_values.h"
#include "cli/output.h"
#include "commands/commands.h"
#include "commands/run/case_run.h"
#include "commands/run/run_files.h"
#include "commands/run/run_json.h"
#include "commands/run/run_text.h"
#include "write/file.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    ARGUMENT_MAX = 256,  // cases, and overrides, of one command line
    KEY_BACKEND = 0x100, // options without a letter of their own
    KEY_STEP,
    KEY_SET,
    KEY_SERIES,
    KEY_JSON,
    KEY_OUT,
    KEY_PLOT,
    KEY_WIDE,
    KEY_QUIET = 'q',
};

typedef struct RunCommand {
    const char *cases[ARGUMENT_MAX];
    size_t case_count;
    char *overrides[ARGUMENT_MAX]; // KEY=VALUE, owned
    size_t override_count;
    Text backends; // names, separated by commas
    const char *series;
    const char *plot;
    const char *folder;
    bool is_json;
    bool is_wide;
    bool is_quiet;
} RunCommand;

static const struct argp_option OPTIONS[] = {
    {"backend", KEY_BACKEND, "NAME[,NAME]", 0, "Run on these instead of the case's run.backends",
     1},
    {"step", KEY_STEP, "TIME", 0, "The step, such as '2 us': short for --set run.step=TIME", 1},
    {"set", KEY_SET, "KEY=VALUE", 0,
     "Replace a value of the case, such as "
     "contact.restitution=0.8; may be given often",
     1},
    {"json", KEY_JSON, NULL, 0, "Print one JSON object instead of tables", 2},
    {"wide", KEY_WIDE, NULL, 0, "All columns of the tables, however wide the terminal is", 2},
    {"series", KEY_SERIES, "FILE.csv", 0,
     "Write every sample; with several backends to "
     "FILE-<backend>.csv each",
     2},
    {"plot", KEY_PLOT, "FILE.svg", 0, "Draw motion, forces and the pin in its hole", 2},
    {"out", KEY_OUT, "DIR", 0, "Write <case>.json, .txt, .svg and <case>-<backend>.csv there", 2},
    {"quiet", KEY_QUIET, NULL, 0, "Nothing on standard error but errors and a warning of long work",
     2},
    {0},
};

static bool add_override(RunCommand *command, const char *key, const char *value, Err *err)
{
    if (command->override_count == ARGUMENT_MAX) {
        return err_set(err, ERR_USAGE, "more than %d settings on one command line", ARGUMENT_MAX);
    }
    Text text;
    text_init(&text);
    text_append(&text, "%s%s", key, value);
    // the text's memory now belongs to the list
    command->overrides[command->override_count++] = text.data;
    return true;
}

static bool add_case(RunCommand *command, const char *path, Err *err)
{
    if (command->case_count == ARGUMENT_MAX) {
        return err_set(err, ERR_USAGE, "more than %d cases on one command line", ARGUMENT_MAX);
    }
    command->cases[command->case_count++] = path;
    return true;
}

static bool take_option(int key, const char *value, void *target, Err *err)
{
    RunCommand *command = target;
    switch (key) {
    case KEY_BACKEND:
        if (value[strspn(value, " \t")] == '\0') {
            return err_set(err, ERR_USAGE, "--backend names no backend; such as --backend ode");
        }
        text_append(&command->backends, "%s%s", command->backends.length > 0 ? ", " : "", value);
        return true;
    case KEY_STEP:
        return add_override(command, "run.step=", value, err);
    case KEY_SET:
        return add_override(command, "", value, err);
    case KEY_SERIES:
        command->series = value;
        return true;
    case KEY_PLOT:
        command->plot = value;
        return true;
    case KEY_OUT:
        command->folder = value;
        return true;
    case KEY_JSON:
        command->is_json = true;
        return true;
    case KEY_WIDE:
        command->is_wide = true;
        return true;
    case KEY_QUIET:
        command->is_quiet = true;
        return true;
    default:
        return add_case(command, value, err);
    }
}

// Loads every case before any runs, so that a mistake in the last is told at once.
static bool load_cases(const RunCommand *command, CaseRun *runs, Err *err)
{
    for (size_t i = 0; i < command->case_count; i++) {
        if (!casefile_load(command->cases[i], (const char *const *)command->overrides,
                           command->override_count, &runs[i].scenario, err)) {
            return false;
        }
    }
    // in one folder, every case needs a name of its own
    for (size_t i = 0; command->folder != NULL && i < command->case_count; i++) {
        char name[SCENARIO_PATH_SIZE];
        char other[SCENARIO_PATH_SIZE];
        file_stem(runs[i].scenario.path, name, sizeof name);
        for (size_t k = 0; k < i; k++) {
            file_stem(runs[k].scenario.path, other, sizeof other);
            if (strcmp(name, other) == 0) {
                return err_set(err, ERR_USAGE, "%s and %s would write the same files into %s",
                               command->cases[k], command->cases[i], command->folder);
            }
        }
    }
    return true;
}

static bool report_case(const RunCommand *command, const CaseRun *run, json_t *objects, Err *err)
{
    if (objects != NULL) {
        json_array_append_new(objects, run_json_build(&run->report));
    } else {
        Text text;
        text_init(&text);
        const Style style = output_style(stdout, command->is_wide);
        run_text_write(&run->report, &style, &text);
        text_append(&text, "\n");
        output_text(&text, &style);
        text_finish(&text);
    }
    const bool is_quiet = command->is_quiet;
    return (command->series == NULL || run_files_series(run, command->series, is_quiet, err)) &&
           (command->plot == NULL || run_files_plot(run, command->plot, is_quiet, err)) &&
           (command->folder == NULL || run_files_folder(run, command->folder, is_quiet, err));
}

// One case is one object, several are {"cases": [...]}.
static void print_json(json_t *objects)
{
    output_json(json_array_size(objects) == 1 ? json_incref(json_array_get(objects, 0))
                                              : json_pack("{s:O}", "cases", objects));
}

static bool count_failures(const RunCommand *command, const CaseRun *runs, Err *err)
{
    size_t failed = 0;
    size_t all = 0;
    const CaseRun *first_case = NULL;
    const Trajectory *first = NULL;
    for (size_t i = 0; i < command->case_count; i++) {
        failed += runs[i].failed_count;
        all += runs[i].report.run_count;
        for (size_t k = 0; k < runs[i].report.run_count && first == NULL; k++) {
            first = runs[i].runs[k]->is_complete ? NULL : runs[i].runs[k];
            first_case = &runs[i];
        }
    }
    return failed == 0 || err_set(err, ERR_SOLVER, "%zu of %zu runs failed: %s on %s: %s", failed,
                                  all, first_case->scenario.path, first->backend, first->message);
}

// What cannot be written is told before anything runs.
static bool claim_files(const RunCommand *command, const CaseRun *runs, Err *err)
{
    if (!run_files_claim(&runs[0], command->series, command->plot, err) ||
        (command->folder != NULL && !file_make_folder(command->folder, err))) {
        return false;
    }
    for (size_t i = 0; command->folder != NULL && i < command->case_count; i++) {
        if (!run_files_claim_folder(&runs[i], command->folder, err)) {
            return false;
        }
    }
    return true;
}

static bool run_cases(const RunCommand *command, CaseRun *runs, Err *err)
{
    if (!load_cases(command, runs, err) || !claim_files(command, runs, err)) {
        return false;
    }
    for (size_t i = 0; !command->is_quiet && i < command->case_count; i++) {
        doubts_say(&runs[i].scenario);
        idle_settings_say(&runs[i].scenario, (const char *const *)command->overrides,
                          command->override_count);
    }
    json_t *objects = command->is_json ? json_array() : NULL;
    bool is_reported = true;
    Progress progress;
    progress_begin(&progress, command->is_quiet);
    for (size_t i = 0; is_reported && i < command->case_count; i++) {
        case_run_execute(&runs[i], &progress);
        is_reported = report_case(command, &runs[i], objects, err);
    }
    if (is_reported && objects != NULL) {
        print_json(objects);
    }
    json_decref(objects);
    return is_reported && count_failures(command, runs, err);
}

static bool check_command(RunCommand *command, Err *err)
{
    if (command->case_count == 0) {
        return err_set(err, ERR_USAGE, "no case given: jointplay run CASE.yaml");
    }
    if (command->case_count > 1 && (command->series != NULL || command->plot != NULL)) {
        return err_set(err, ERR_USAGE, "--%s takes one case; --out DIR takes several",
                       command->series != NULL ? "series" : "plot");
    }
    if (!option_values_check_picture("--plot", command->plot, err)) {
        return false;
    }
    if (command->backends.length > 0) {
        Text text;
        text_init(&text);
        text_append(&text, "[%s]", command->backends.data);
        const bool is_added = add_override(command, "run.backends=", text.data, err);
        text_finish(&text);
        return is_added;
    }
    return true;
}

static bool run_run(int argc, char **argv, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay run",
        .usage = "CASE...",
        .doc = "Runs a case on its backends and prints extremes, spikes, error and cost."
               "\vWith --json one case is one object; several are {\"cases\": [...]}. "
               "'jointplay help case' lists what can be set.",
        .options = OPTIONS,
        .take = take_option,
    };
    RunCommand command = {0};
    text_init(&command.backends);
    bool is_answered;
    const bool is_read = arguments_parse(&ARGUMENTS, argc, argv, &command, &is_answered, err);
    if (is_read && !is_answered && check_command(&command, err)) {
        CaseRun *runs = calloc(command.case_count, sizeof *runs);
        assert(runs != NULL);
        run_cases(&command, runs, err);
        for (size_t i = 0; i < command.case_count; i++) {
            case_run_finish(&runs[i]);
        }
        free(runs);
    }
    for (size_t i = 0; i < command.override_count; i++) {
        free(command.overrides[i]);
    }
    text_finish(&command.backends);
    return err->kind == ERR_NONE;
}

const Command cmd_run = {
    .name = "run",
    .summary = "runs a case on its backends: extremes, spikes, error, cost",
    .run = run_run,
};

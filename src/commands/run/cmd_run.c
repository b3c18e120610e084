// Runs a case on each of its backends and prints what came out.
#include "cli/output.h"
#include "cli/results.h"
#include "cli/warnings.h"
#include "commands/commands.h"
#include "commands/run/run_choices.h"
#include "commands/run/run_files.h"
#include "commands/run/run_overview.h"
#include "write/file.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CASE_MAX = 256 }; // on one command line

typedef struct RunCommand {
    RunChoices choices; // without a path
    const char *cases[CASE_MAX];
    size_t case_count;
    const char *series;
    const char *columns;
    const char *contacts;
    const char *plot;
    const char *force_axis; // one of FORCE_AXES
} RunCommand;

#define AT(field) .offset = offsetof(RunCommand, field)

static const char *const FORCE_AXES[] = {"linear", "log", NULL};

static const OptionRow RUN_OPTIONS[] = {
    RUN_CHOICES(1),
    COMMON_JSON(2),
    COMMON_FULL(2),
    COMMON_WIDE(2),
    {"series", "FILE.csv", "Write every sample; with several backends to FILE-<backend>.csv each",
     2, OPTION_TEXT, AT(series)},
    {"columns", "NAME[,NAME]",
     "Write the time and these columns of the series alone, such as 'crank_deg,rod_*'", 2,
     OPTION_TEXT, AT(columns)},
    {"contacts", "FILE.csv",
     "Write every contact, likewise; with several backends to FILE-<backend>.csv each", 2,
     OPTION_TEXT, AT(contacts)},
    {"plot", "FILE.svg", "Draw motion, forces and the pin in its hole", 2, OPTION_PICTURE,
     AT(plot)},
    {"force-axis", "SCALE", "Forces in the picture: linear (default) or log", 2, OPTION_CHOICE,
     AT(force_axis), .words = FORCE_AXES},
    COMMON_OUT(2, "Write <case>.json, .txt, .svg, <case>-<backend>.csv and -contacts.csv there"),
    COMMON_QUIET(2),
};

// Loads every case before any runs, so that a mistake in the last is reported at once.
static bool load_cases(const RunCommand *command, CaseRun *runs, Err *err)
{
    for (size_t i = 0; i < command->case_count; i++) {
        if (!run_choices_load(&command->choices, command->cases[i], &runs[i], err)) {
            return false;
        }
        runs[i].columns = command->columns;
        // of samples in a file and of pictures
        const bool has_folder = command->choices.common.folder != NULL;
        runs[i].scenario.run.keeps_ranges =
            command->series != NULL || command->plot != NULL || has_folder;
        runs[i].scenario.run.keeps_marks = command->plot != NULL || has_folder;
        runs[i].scenario.run.keeps_contacts = command->contacts != NULL || has_folder;
        if (!run_files_check_columns(&runs[i], err)) {
            return false;
        }
    }
    // in one folder, every case needs a name of its own
    for (size_t i = 0; command->choices.common.folder != NULL && i < command->case_count; i++) {
        char name[SCENARIO_PATH_SIZE];
        char other[SCENARIO_PATH_SIZE];
        file_stem(scenario_path(&runs[i].scenario), name, sizeof name);
        for (size_t k = 0; k < i; k++) {
            file_stem(scenario_path(&runs[k].scenario), other, sizeof other);
            if (strcmp(name, other) == 0) {
                return err_set(err, ERR_USAGE, "%s and %s would write the same files into %s",
                               command->cases[k], command->cases[i],
                               command->choices.common.folder);
            }
        }
    }
    return true;
}

static const ResultFile RUN_FILES[] = {
    {"--plot", offsetof(RunCommand, plot), ".svg", FILE_PICTURE, .text = plot_run_write},
    {.ending = ".txt", .kind = FILE_REPORT},
    {.ending = ".json", .kind = FILE_RESULT},
};

static const Results RUN_RESULTS = {
    .suffix = "",
    .is_followed = true,
    .json = run_json_build,
    .text = run_text_write,
    .screen = run_overview_screen,
    RESULT_FILES(RUN_FILES),
};

// What is printed of a case so far.
typedef struct Printing {
    const CommonOptions *options;
    Progress *progress;
    Text begun;
} Printing;

static void print_answer(const RunReport *report, void *listener)
{
    Printing *printing = listener;
    progress_end(printing->progress);
    results_print_begin(printing->options, run_overview_answer, report, &printing->begun);
}

static bool report_case(const RunCommand *command, const CaseRun *run, const Text *begun,
                        json_t *objects, Err *err)
{
    const CommonOptions *common = &command->choices.common;
    if (objects != NULL) {
        json_array_append_new(objects, run_json_build(&run->report));
    } else {
        results_print_rest(&RUN_RESULTS, common, &run->report, begun);
    }
    return (command->series == NULL ||
            run_files_write(run, RUN_SERIES, command->series, common->is_quiet, err)) &&
           (command->contacts == NULL ||
            run_files_write(run, RUN_CONTACTS, command->contacts, common->is_quiet, err)) &&
           (common->folder == NULL || run_files_folder(run, common, err)) &&
           results_write(&RUN_RESULTS, common, scenario_path(&run->scenario), &run->report, err);
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
    return failed == 0 ||
           err_set(err, ERR_SOLVER, "%zu of %zu runs failed: %s on %s: %s", failed, all,
                   scenario_path(&first_case->scenario), first->backend, first->message);
}

// What cannot be written is reported before anything runs.
static bool claim_files(const RunCommand *command, const CaseRun *runs, Err *err)
{
    const CommonOptions *common = &command->choices.common;
    bool is_claimed =
        (command->series == NULL || run_files_claim(&runs[0], RUN_SERIES, command->series, err)) &&
        (command->contacts == NULL ||
         run_files_claim(&runs[0], RUN_CONTACTS, command->contacts, err));
    for (size_t i = 0; i < command->case_count && is_claimed; i++) {
        is_claimed = results_claim(&RUN_RESULTS, common, scenario_path(&runs[i].scenario), err) &&
                     (common->folder == NULL || run_files_claim_folder(&runs[i], common, err));
    }
    return is_claimed;
}

static bool run_all(const RunCommand *command, CaseRun *runs, Err *err)
{
    if (!load_cases(command, runs, err) || !claim_files(command, runs, err)) {
        return false;
    }
    for (size_t i = 0; i < command->case_count; i++) {
        warnings_say(&runs[i].scenario, &command->choices.common);
    }
    json_t *objects = command->choices.common.is_json ? json_array() : NULL;
    bool is_reported = true;
    Progress progress;
    progress_begin(&progress, command->choices.common.is_quiet);
    const CaseWatch watch = run_files_watch(&progress);
    for (size_t i = 0; is_reported && i < command->case_count; i++) {
        runs[i].is_whole = results_tell_all(&RUN_RESULTS, &command->choices.common);
        Printing printing = {.options = &command->choices.common, .progress = &progress};
        text_init(&printing.begun);
        runs[i].answered = print_answer;
        runs[i].listener = &printing;
        case_run_execute(&runs[i], &watch);
        runs[i].report.has_log_forces = strcmp(command->force_axis, "log") == 0;
        is_reported = report_case(command, &runs[i], &printing.begun, objects, err);
        text_finish(&printing.begun);
    }
    if (is_reported && objects != NULL) {
        print_json(objects);
    }
    json_decref(objects);
    return is_reported && count_failures(command, runs, err);
}

static bool check_command(void *target, Err *err)
{
    RunCommand *command = target;
    if (command->case_count == 0) {
        return err_set(err, ERR_USAGE, "no case given: jointplay run CASE.yaml");
    }
    const char *single = command->series != NULL     ? "series"
                         : command->contacts != NULL ? "contacts"
                         : command->plot != NULL     ? "plot"
                                                     : NULL;
    if (command->case_count > 1 && single != NULL) {
        return err_set(err, ERR_USAGE, "--%s takes one case; --out DIR takes several", single);
    }
    if (command->columns != NULL && command->series == NULL &&
        command->choices.common.folder == NULL) {
        return err_set(
            err, ERR_USAGE,
            "--columns chooses from the series: give --series FILE.csv or --out DIR too");
    }
    if (command->force_axis != FORCE_AXES[0] && command->plot == NULL &&
        command->choices.common.folder == NULL) {
        return err_set(err, ERR_USAGE,
                       "--force-axis is of the picture: give --plot FILE.svg or --out DIR too");
    }
    return run_choices_end(&command->choices, err);
}

static bool run_cases(void *target, Err *err)
{
    const RunCommand *command = target;
    CaseRun *runs = calloc(command->case_count, sizeof *runs);
    assert(runs != NULL);
    const bool is_done = run_all(command, runs, err);
    for (size_t i = 0; i < command->case_count; i++) {
        case_run_finish(&runs[i]);
    }
    free(runs);
    return is_done;
}

static const Arguments RUN_ARGUMENTS = {
    .program = "jointplay run",
    .usage = "CASE...",
    .doc = "Runs a case on its backends and prints extremes, spikes, error and cost."
           "\vWith --json one case is one object; several are {\"cases\": [...]}. "
           "'jointplay help case --all' lists what can be set.",
    .argument = {.type = OPTION_LIST,
                 AT(cases),
                 .count_offset = offsetof(RunCommand, case_count),
                 .high = CASE_MAX,
                 .what = "cases"},
    OPTION_ROWS(RUN_OPTIONS),
    .check = check_command,
};
#undef AT

static bool run_run(int argc, char **argv, Err *err)
{
    RunCommand command = {.force_axis = FORCE_AXES[0]};
    run_choices_begin(&command.choices);
    const bool is_done = arguments_run(&RUN_ARGUMENTS, argc, argv, &command, run_cases, err);
    run_choices_finish(&command.choices);
    return is_done;
}

const Command cmd_run = {
    .name = "run",
    .summary = "runs a case on its backends: extremes, spikes, error, cost",
    .run = run_run,
    .arguments = &RUN_ARGUMENTS,
};

// Writes one HTML file: of a case, which is run on its backends, of a study, or of results.
#include "base/shell.h"
#include "cli/output.h"
#include "cli/warnings.h"
#include "cli/written.h"
#include "commands/commands.h"
#include "commands/report/report_page.h"
#include "commands/report/report_result.h"
#include "commands/report/report_study.h"
#include "commands/run/run_choices.h"
#include "commands/run/run_files.h"
#include "write/file.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef struct ReportCommand {
    RunChoices choices;
    const char *out; // NULL: <case>.html
    size_t path_count;
    const char *paths[RESULT_MOST]; // one case, one store, or results
} ReportCommand;

static const OptionRow REPORT_OPTIONS[] = {
    RUN_CHOICES(1),
    {"out", "FILE.html", "Write this file; without it <name>.html in the current folder", 2,
     OPTION_TEXT, .offset = offsetof(ReportCommand, out), .letter = 'o'},
    COMMON_QUIET(2),
};

// The command that makes the page again.
static void append_command(const ReportCommand *command, const char *path, Text *text)
{
    const CommonOptions *common = &command->choices.common;
    text_append(text, "jointplay report");
    for (size_t i = 0; i < command->path_count; i++) {
        const char *of = command->paths[i];
        text_append(text, " ");
        if (strcmp(of, "-") == 0) {
            text_append(text, "-");
        } else {
            shell_append_path(text, of);
        }
    }
    for (size_t i = 0; i < common->override_count; i++) {
        text_append(text, " --set ");
        shell_append_word(text, common->overrides[i]);
    }
    text_append(text, "%s --out ", command->choices.is_uncertified ? " --uncertified" : "");
    shell_append_path(text, path);
}

// The path of the page: that of --out, or after the file that it is of.
static void find_path(const ReportCommand *command, const char *of, char path[FILE_PATH_SIZE])
{
    if (command->out != NULL) {
        snprintf(path, FILE_PATH_SIZE, "%s", command->out);
    } else {
        char name[SCENARIO_PATH_SIZE - 8];
        file_stem(of, name, sizeof name);
        snprintf(path, FILE_PATH_SIZE, "%s.html", name);
    }
}

static bool write_page(const ReportCommand *command, const CaseRun *run, const char *path, Err *err)
{
    Text line;
    Text html;
    text_init(&line);
    text_init(&html);
    append_command(command, path, &line);
    report_page_write(&(ReportPage){.report = &run->report, .command = line.data}, &html);
    const bool is_written =
        written_text(FILE_PAGE, path, html.data, command->choices.common.is_quiet, err);
    text_finish(&html);
    text_finish(&line);
    return is_written;
}

static bool check_failures(const CaseRun *run, Err *err)
{
    for (size_t i = 0; i < run->report.run_count; i++) {
        const Trajectory *trajectory = run->runs[i];
        if (!trajectory->is_complete) {
            return err_set(err, ERR_SOLVER, "%zu of %zu runs failed: %s on %s: %s",
                           run->failed_count, run->report.run_count, scenario_path(&run->scenario),
                           trajectory->backend, trajectory->message);
        }
    }
    return true;
}

static bool make_report(const ReportCommand *command, CaseRun *run, Err *err)
{
    const CommonOptions *common = &command->choices.common;
    char path[FILE_PATH_SIZE];
    if (!run_choices_load(&command->choices, common->path, run, err)) {
        return false;
    }
    find_path(command, scenario_path(&run->scenario), path);
    // what cannot be written is reported before anything runs
    if (!file_claim("--out", FILE_PAGE, path, err)) {
        return false;
    }
    warnings_say(&run->scenario, common);
    run->scenario.run.keeps_ranges = true;
    run->scenario.run.keeps_marks = true;
    run->is_whole = true;
    Progress progress;
    progress_begin(&progress, common->is_quiet);
    const CaseWatch watch = run_files_watch(&progress);
    case_run_execute(run, &watch);
    return write_page(command, run, path, err) && check_failures(run, err);
}

static bool report_case(const ReportCommand *command, Err *err)
{
    CaseRun run = {0};
    const bool is_done = make_report(command, &run, err);
    case_run_finish(&run);
    return is_done;
}

// Of what is there already: results, or the store of a study.
static bool report_files(const ReportCommand *command, bool is_store, Err *err)
{
    char path[FILE_PATH_SIZE];
    Text line;
    Text html;
    text_init(&line);
    text_init(&html);
    find_path(command, command->paths[0], path);
    append_command(command, path, &line);
    const ResultPage page = {command->path_count, command->paths, line.data};
    const bool is_done =
        (is_store ? study_page_write(command->paths[0], line.data, &html, err)
                  : result_page_write(&page, &html, err)) &&
        file_claim("--out", FILE_PAGE, path, err) &&
        written_text(FILE_PAGE, path, html.data, command->choices.common.is_quiet, err);
    text_finish(&html);
    text_finish(&line);
    return is_done;
}

// Whether options that a case is run with were given for what is over already. ERR_USAGE.
static bool refuse_choices(const ReportCommand *command, const char *path, Err *err)
{
    return (command->choices.common.override_count == 0 && !command->choices.is_uncertified) ||
           err_set(err, ERR_USAGE,
                   "%s is what came of runs; --set, --step, --backend and --uncertified are for a "
                   "case that is run",
                   path);
}

static bool report_any(void *target, Err *err)
{
    ReportCommand *command = target;
    const char *first = command->paths[0];
    const bool is_store = study_page_is_store(first) || study_page_is_study(first);
    const bool is_result = !is_store && result_is_one(first);
    if (is_store && command->path_count > 1) {
        return err_set(
            err, ERR_USAGE,
            "report takes one study; 'jointplay study merge' makes one store of several");
    }
    if (is_store || is_result) {
        return refuse_choices(command, first, err) && report_files(command, is_store, err);
    }
    if (command->path_count > 1) {
        return err_set(
            err, ERR_USAGE,
            "report takes one case, or results of compare, map, tune, check and paper; %s is "
            "none of these results",
            first);
    }
    command->choices.common.path = first;
    return report_case(command, err);
}

// A page is HTML, and a name that ends otherwise asks for something else.
static bool check_page(const char *path, Err *err)
{
    const char *slash = path != NULL ? strrchr(path, '/') : NULL;
    const char *name = slash != NULL ? slash + 1 : path;
    const char *dot = name != NULL ? strrchr(name, '.') : NULL;
    return dot == NULL || dot == name || dot[1] == '\0' || strcasecmp(dot, ".html") == 0 ||
           strcasecmp(dot, ".htm") == 0 ||
           err_set(err, ERR_USAGE, "--out: %s: a page is written as HTML alone; allowed: %.*s.html",
                   path, (int)(dot - path), path);
}

static bool check_command(void *target, Err *err)
{
    ReportCommand *command = target;
    if (command->path_count == 0) {
        return err_set(err, ERR_USAGE, "no case given: jointplay report CASE.yaml");
    }
    return check_page(command->out, err) && run_choices_end(&command->choices, err);
}

static const Arguments REPORT_ARGUMENTS = {
    .program = "jointplay report",
    .usage = "CASE|STUDY|STORE|RESULT.json...",
    .doc = "Writes one HTML file that opens offline: of a case, which is run, the answer, the "
           "mechanism moving, and plots; of a study, which has been made, or its store "
           "distributions, maps over two keys and its bifurcation; of results of compare, map, "
           "tune, check and paper, written with "
           "--json or --out, what they found."
           "\vThe page needs no other file and asks nothing of any other place. Without script it "
           "has the same answer, tables and pictures.",
    .argument = {.type = OPTION_LIST,
                 .offset = offsetof(ReportCommand, paths),
                 .count_offset = offsetof(ReportCommand, path_count),
                 .high = RESULT_MOST,
                 .what = "files"},
    OPTION_ROWS(REPORT_OPTIONS),
    .check = check_command,
};

static bool run_report(int argc, char **argv, Err *err)
{
    ReportCommand command = {0};
    run_choices_begin(&command.choices);
    const bool is_done = arguments_run(&REPORT_ARGUMENTS, argc, argv, &command, report_any, err);
    run_choices_finish(&command.choices);
    return is_done;
}

const Command cmd_report = {
    .name = "report",
    .summary = "one HTML file of a case, a study or results: motion, plots, tables",
    .run = run_report,
    .arguments = &REPORT_ARGUMENTS,
};

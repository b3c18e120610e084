// Runs a case on its backends and writes one HTML file that shows what came out.
#include "base/shell.h"
#include "casefile/input.h"
#include "cli/output.h"
#include "cli/warnings.h"
#include "cli/written.h"
#include "commands/commands.h"
#include "commands/report/report_page.h"
#include "commands/run/run_choices.h"
#include "write/file.h"

#include <stdio.h>
#include <string.h>

typedef struct ReportCommand {
    RunChoices choices;
    const char *out; // NULL: <case>.html
} ReportCommand;

static const OptionRow OPTIONS[] = {
    RUN_CHOICES(1),
    {"out", "FILE.html", "Write this file; without it <case>.html in the current folder", 2,
     OPTION_TEXT, .offset = offsetof(ReportCommand, out), .letter = 'o'},
    COMMON_QUIET(2),
};

// The command that makes the page again.
static void append_command(const ReportCommand *command, const char *path, Text *text)
{
    const CommonOptions *common = &command->choices.common;
    const char *case_path = common->path;
    text_append(text, "jointplay report ");
    shell_append_path(text, strcmp(case_path, INPUT_STDIN) == 0 ? "-" : case_path);
    for (size_t i = 0; i < common->override_count; i++) {
        text_append(text, " --set ");
        shell_append_word(text, common->overrides[i]);
    }
    text_append(text, "%s --out ", command->choices.is_uncertified ? " --uncertified" : "");
    shell_append_path(text, path);
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
    if (command->out != NULL) {
        snprintf(path, sizeof path, "%s", command->out);
    } else {
        char name[SCENARIO_PATH_SIZE - 8];
        file_stem(scenario_path(&run->scenario), name, sizeof name);
        snprintf(path, sizeof path, "%s.html", name);
    }
    // what cannot be written is reported before anything runs
    if (!file_claim("--out", FILE_PAGE, path, err)) {
        return false;
    }
    warnings_say(&run->scenario, common);
    run->scenario.run.keeps_ranges = true;
    Progress progress;
    progress_begin(&progress, common->is_quiet);
    case_run_execute(run, &progress);
    return write_page(command, run, path, err) && check_failures(run, err);
}

static bool report_case(void *target, Err *err)
{
    const ReportCommand *command = target;
    CaseRun run = {0};
    const bool is_done = make_report(command, &run, err);
    case_run_finish(&run);
    return is_done;
}

static bool check_command(void *target, Err *err)
{
    ReportCommand *command = target;
    if (command->choices.common.path == NULL) {
        return err_set(err, ERR_USAGE, "no case given: jointplay report CASE.yaml");
    }
    return run_choices_end(&command->choices, err);
}

static const Arguments REPORT_ARGUMENTS = {
    .program = "jointplay report",
    .usage = "CASE",
    .doc = "Runs a case on its backends and writes one HTML file that opens offline: the answer, "
           "the mechanism moving, and plots."
           "\vThe page needs no other file and asks nothing of any other place. Without script "
           "it has the same answer, tables and a picture.",
    .argument = COMMON_PATH("report takes one case"),
    OPTION_ROWS(OPTIONS),
    .check = check_command,
};

static bool run_report(int argc, char **argv, Err *err)
{
    ReportCommand command = {0};
    run_choices_begin(&command.choices);
    const bool is_done = arguments_run(&REPORT_ARGUMENTS, argc, argv, &command, report_case, err);
    run_choices_finish(&command.choices);
    return is_done;
}

const Command cmd_report = {
    .name = "report",
    .summary = "runs a case and writes one HTML file: motion, plots, tables",
    .run = run_report,
    .arguments = &REPORT_ARGUMENTS,
};

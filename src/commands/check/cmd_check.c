// Have the numbers of any case moved by more than they may?
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/written.h"
#include "commands/check/check_json.h"
#include "commands/check/check_junit.h"
#include "commands/check/check_markdown.h"
#include "commands/check/check_options.h"
#include "commands/check/check_run.h"
#include "commands/check/check_text.h"
#include "commands/commands.h"
#include "write/file.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

static bool write_with(FileKind kind, void (*write)(const CheckReport *report, Text *text),
                       const CheckReport *report, const char *path, bool is_quiet, Err *err)
{
    if (path == NULL) {
        return true;
    }
    Text text;
    text_init(&text);
    write(report, &text);
    const bool is_written =
        written_text(kind, path, text.data, is_quiet || file_is_stream(path), err);
    text_finish(&text);
    return is_written;
}

// A comment that is printed takes the place of the tables.
static bool prints_markdown(const CheckOptions *options)
{
    return options->markdown != NULL && file_is_stream(options->markdown);
}

static void print_report(const CheckReport *report, const CheckOptions *options)
{
    if (options->common.is_json) {
        output_json(check_json_build(report));
        return;
    }
    if (prints_markdown(options)) {
        return;
    }
    Text text;
    text_init(&text);
    const Style style = output_style(stdout, options->common.is_wide);
    check_text_write(report, options->is_all, &style, &text);
    output_text(&text, &style);
    text_finish(&text);
}

// A limit of the case itself comes before what its baseline says.
static bool refuse_case(const CheckReport *report, const CheckCase *item, Err *err)
{
    char words[CHECK_WORDS_SIZE];
    const size_t differing = check_report_differing(report);
    for (size_t i = 0; i < item->limit_count; i++) {
        const CheckLimit *limit = &item->limits[i];
        if (limit->verdict != CHECK_WITHIN) {
            check_report_limit(limit, words);
            return err_set(err, ERR_DIFFERS, "%zu of %zu cases out of limits or bands; %s: %s %s",
                           differing, report->case_count, item->path, limit->name, words);
        }
    }
    const CheckRow *worst = &item->rows[0];
    check_report_words(worst, words);
    return err_set(err, ERR_DIFFERS, "%zu of %zu cases differ from their baselines; %s: %s%s%s",
                   differing, report->case_count, item->path,
                   worst->verdict == CHECK_SETTING ? "" : worst->name,
                   worst->verdict == CHECK_SETTING ? "" : " ", words);
}

// How it ends: a case that could not be checked weighs more than a number that moved.
static bool conclude(const CheckReport *report, Err *err)
{
    for (size_t i = 0; i < report->case_count; i++) {
        const CheckCase *item = &report->cases[i];
        if (item->err.kind != ERR_NONE) {
            err_set_lines(err, item->err.kind, item->err.text);
            if (item->err.kind == ERR_SOLVER) {
                err_prefix(err, item->path);
            }
            return false;
        }
    }
    for (size_t i = 0; !report->is_blessed && i < report->case_count; i++) {
        if (check_report_is_out(&report->cases[i])) {
            return refuse_case(report, &report->cases[i], err);
        }
    }
    return true;
}

static bool claim_files(const CheckOptions *options, Err *err)
{
    return (options->junit == NULL || file_claim("--junit", FILE_JUNIT, options->junit, err)) &&
           (options->markdown == NULL ||
            file_claim("--markdown", FILE_COMMENT, options->markdown, err));
}

// Who was stopped while making baselines has been told what is kept, and ends by the same signal.
static void end_if_stopped(void)
{
    fflush(stdout);
    interrupt_obey();
}

static bool check_items(const CheckOptions *options, CheckItem *items, size_t count, Err *err)
{
    CheckRun run = {.cases = NULL};
    bool is_done = true;
    if (options->is_blessing) {
        check_run_bless(options, items, count, &run);
    } else {
        is_done = check_run_execute(options, items, count, &run, err);
    }
    if (is_done) {
        print_report(&run.report, options);
        is_done = write_with(FILE_JUNIT, check_junit_write, &run.report, options->junit,
                             options->common.is_quiet, err) &&
                  write_with(FILE_COMMENT, check_markdown_write, &run.report, options->markdown,
                             options->common.is_quiet, err);
        end_if_stopped();
        is_done = is_done && conclude(&run.report, err);
    }
    check_run_finish(&run);
    return is_done;
}

static bool run_check(int argc, char **argv, Err *err)
{
    CheckOptions *options = calloc(1, sizeof *options);
    assert(options != NULL);
    bool is_answered;
    bool is_done = check_options_read(argc, argv, options, &is_answered, err);
    if (is_done && !is_answered) {
        CheckItem *items = NULL;
        size_t count = 0;
        is_done = (!options->is_blessing || file_make_folder(options->folder, err)) &&
                  check_list_make(options, &items, &count, err) && claim_files(options, err) &&
                  check_items(options, items, count, err);
        check_list_destroy(items, count);
    }
    free(options);
    return is_done;
}

const Command cmd_check = {
    .name = "check",
    .summary = "regression of spikes and all other numbers against baselines",
    .run = run_check,
};

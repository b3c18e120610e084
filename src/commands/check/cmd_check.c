// The command `jointplay check`: its flow and its output.
#include "cli/interrupt.h"
#include "cli/results.h"
#include "commands/check/check_list.h"
#include "commands/check/check_report.h"
#include "commands/check/check_run.h"
#include "commands/commands.h"
#include "write/file.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

static const ResultFile CHECK_FILES[] = {
    {"--junit", offsetof(CheckOptions, junit), .kind = FILE_JUNIT, .text = check_junit_write},
    {"--markdown", offsetof(CheckOptions, markdown), .kind = FILE_COMMENT,
     .text = check_markdown_write},
};

static const Results CHECK_RESULTS = {
    .json = check_json_build, .text = check_text_write, RESULT_FILES(CHECK_FILES)};

// The settings that are others, or, where all are as they were, the number that moved most.
static void append_moved(const CheckCase *item, Text *text)
{
    char words[CHECK_WORDS_SIZE];
    for (size_t i = 0; i < item->row_count && item->rows[i].verdict == CHECK_SETTING; i++) {
        check_report_words(&item->rows[i], words);
        text_append(text, "%s%s", i > 0 ? "; " : "", words);
    }
    if (text->length == 0) {
        check_report_words(&item->rows[0], words);
        text_append(text, "%s %s", item->rows[0].name, words);
    }
}

// A limit or an outcome of the case itself comes before what its baseline says.
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
    for (size_t i = 0; i < item->outcome_count; i++) {
        const CheckOutcome *outcome = &item->outcomes[i];
        if (!outcome->is_as_expected) {
            check_outcome_words(outcome, words);
            return err_set(err, ERR_DIFFERS,
                           "%zu of %zu cases end otherwise than expected, or are out of limits or "
                           "bands; %s: %s: %s",
                           differing, report->case_count, item->path, outcome->name, words);
        }
    }
    Text moved;
    text_init(&moved);
    append_moved(item, &moved);
    err_set(err, ERR_DIFFERS, "%zu of %zu cases differ from their baselines; %s: %s", differing,
            report->case_count, item->path, moved.data);
    text_finish(&moved);
    return false;
}

// How it ends: a case that could not be checked weighs more than a number that moved.
static bool cmd_check_conclude(const CheckReport *report, Err *err)
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

// Ends by the signal that interrupted the work; what is kept was reported.
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
        run.report.is_all = options->is_all;
        // a comment that is printed takes the place of the tables
        if (options->markdown == NULL || !file_is_stream(options->markdown)) {
            results_print(&CHECK_RESULTS, &options->common, &run.report);
        }
        is_done = results_write(&CHECK_RESULTS, &options->common, "", &run.report, err);
        end_if_stopped();
        is_done = is_done && cmd_check_conclude(&run.report, err);
    }
    check_run_finish(&run);
    return is_done;
}

static bool check_cases(void *target, Err *err)
{
    const CheckOptions *options = target;
    CheckItem *items = NULL;
    size_t count = 0;
    const bool is_done = (!options->is_blessing || file_make_folder(options->folder, err)) &&
                         check_list_make(options, &items, &count, err) &&
                         results_claim(&CHECK_RESULTS, &options->common, "", err) &&
                         check_items(options, items, count, err);
    check_list_destroy(items, count);
    return is_done;
}

static bool run_check(int argc, char **argv, Err *err)
{
    CheckOptions *options = malloc(sizeof *options);
    assert(options != NULL);
    check_options_init(options);
    const bool is_done = arguments_run(&CHECK_ARGUMENTS, argc, argv, options, check_cases, err);
    free(options);
    return is_done;
}

const Command cmd_check = {
    .name = "check",
    .summary = "regression of spikes and all other numbers against baselines",
    .run = run_check,
    .arguments = &CHECK_ARGUMENTS,
};

// What did the paper compute, and what comes out when it is computed again?
#include "cli/arguments.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "commands/commands.h"
#include "commands/paper/paper_json.h"
#include "commands/paper/paper_text.h"
#include "write/json_value.h"

#include <assert.h>
#include <stdlib.h>

typedef struct PaperOptions {
    bool is_json;
    bool is_wide;
    bool is_quiet;
} PaperOptions;

enum { KEY_JSON = 0x100, KEY_WIDE, KEY_QUIET = 'q' };

static const struct argp_option OPTIONS[] = {
    {"json", KEY_JSON, NULL, 0, "Print one JSON object instead of tables", 0},
    {"wide", KEY_WIDE, NULL, 0, "All columns of the tables, however wide the terminal is", 0},
    {"quiet", KEY_QUIET, NULL, 0, "Nothing on standard error but errors and a warning of long work",
     0},
    {0},
};

static bool take_option(int key, const char *value, void *target, Err *err)
{
    PaperOptions *options = target;
    switch (key) {
    case KEY_JSON:
        options->is_json = true;
        return true;
    case KEY_WIDE:
        options->is_wide = true;
        return true;
    case KEY_QUIET:
        options->is_quiet = true;
        return true;
    default:
        return err_set(err, ERR_USAGE, "'jointplay paper' takes no argument, and '%s' is one",
                       value);
    }
}

static void print_result(const PaperResult *result, const PaperOptions *options)
{
    if (options->is_json) {
        output_json(paper_json_make(result));
        return;
    }
    Text text;
    text_init(&text);
    const Style style = output_style(stdout, options->is_wide);
    paper_text_write(result, &style, &text);
    output_text(&text, &style);
    text_finish(&text);
}

static bool run_paper(int argc, char **argv, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay paper",
        .doc = "Recomputes the tables of the paper the program grew from: printed, recomputed, "
               "difference, and what physics gives.",
        .options = OPTIONS,
        .take = take_option,
    };
    PaperOptions options = {0};
    bool is_answered;
    if (!arguments_parse(&ARGUMENTS, argc, argv, &options, &is_answered, err) || is_answered) {
        return err->kind == ERR_NONE;
    }
    PaperResult *result = calloc(1, sizeof *result);
    assert(result != NULL);
    Progress progress;
    progress_begin(&progress, options.is_quiet);
    const RunWatch watch = progress_watch(&progress, "paper");
    const bool is_computed = paper_compute(result, watch, err);
    progress_end(&progress);
    if (is_computed) {
        print_result(result, &options);
    }
    const bool is_reproduced = is_computed && paper_check(result, err);
    free(result);
    return is_reproduced;
}

const Command cmd_paper = {
    .name = "paper",
    .summary = "recomputes the paper's tables and holds them against the printed ones",
    .run = run_paper,
};

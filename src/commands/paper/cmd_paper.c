// What did the paper compute, and what comes out when it is computed again?
#include "cli/common_options.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "commands/commands.h"
#include "commands/paper/paper_json.h"
#include "commands/paper/paper_text.h"
#include "write/json_value.h"

#include <assert.h>
#include <stdlib.h>

static const OptionRow OPTIONS[] = {COMMON_JSON(0), COMMON_WIDE(0), COMMON_QUIET(0)};

static void print_result(const PaperResult *result, const CommonOptions *options)
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
        OPTION_ROWS(OPTIONS),
    };
    CommonOptions options = {0};
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

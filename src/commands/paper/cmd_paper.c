// The command `jointplay paper`.
#include "cli/progress.h"
#include "cli/results.h"
#include "commands/commands.h"
#include "commands/paper/paper.h"

#include <assert.h>
#include <stdlib.h>

static const OptionRow PAPER_OPTIONS[] = {COMMON_JSON(0), COMMON_WIDE(0), COMMON_QUIET(0)};

static const Results PAPER_RESULTS = {.json = paper_json_make, .text = paper_text_write};

static bool compute(void *target, Err *err)
{
    const CommonOptions *options = target;
    PaperResult *result = calloc(1, sizeof *result);
    assert(result != NULL);
    Progress progress;
    progress_begin(&progress, options->is_quiet);
    const RunWatch watch = progress_watch(&progress, "paper");
    const bool is_computed = paper_compute(result, watch, err);
    progress_end(&progress);
    if (is_computed) {
        results_print(&PAPER_RESULTS, options, result);
    }
    const bool is_reproduced = is_computed && paper_check(result, err);
    free(result);
    return is_reproduced;
}

static const Arguments PAPER_ARGUMENTS = {
    .program = "jointplay paper",
    .doc = "Recomputes the tables of the paper that this program began with: printed, "
           "recomputed, difference, and what physics gives.",
    OPTION_ROWS(PAPER_OPTIONS),
};

static bool run_paper(int argc, char **argv, Err *err)
{
    CommonOptions options = {0};
    return arguments_run(&PAPER_ARGUMENTS, argc, argv, &options, compute, err);
}

const Command cmd_paper = {
    .name = "paper",
    .summary = "recomputes the paper's tables and compares them with the printed ones",
    .run = run_paper,
    .arguments = &PAPER_ARGUMENTS,
};

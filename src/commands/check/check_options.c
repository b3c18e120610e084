// What was `jointplay check` asked for?
#include "commands/check/check_options.h"

#include "write/file.h"

static const char DEFAULT_FOLDER[] = "results/baseline";
static const double DEFAULT_TIME_LIMIT = 600.0; // s: some hundred times the longest usual start
enum { SHAKE_MAX = 1000000 };

#define AT(field) .offset = offsetof(CheckOptions, field)

static const OptionRow OPTIONS[] = {
    {"baselines", "DIR", "Where the baselines are (default: results/baseline)", 1, OPTION_TEXT,
     AT(folder)},
    {"bless", NULL, "Write new baselines from what is measured now, and list what moved", 1,
     OPTION_FLAG, AT(is_blessing)},
    {"quick", NULL, "One run per case: no ensembles, no orders", 1, OPTION_FLAG, AT(is_quick)},
    {"expect-only", NULL, "Judge cases by their own limits (expect:), not by baselines", 1,
     OPTION_FLAG, AT(is_expect_only)},
    COMMON_SET(1),
    {"shake", "SEED",
     "Change every input by rounding first, as another machine might: a way to test the bands", 1,
     OPTION_COUNT, AT(shake), .low = 1, .high = SHAKE_MAX},
    COMMON_JOBS(2, "Starts at a time (default: one per core)"),
    COMMON_TIME_LIMIT(2, "A start that takes longer has failed (default: 600 s)"),
    {"all", NULL, "Every number in the tables, not only the worst", 3, OPTION_FLAG, AT(is_all)},
    COMMON_JSON(3),
    COMMON_WIDE(3),
    {"junit", "FILE", "Write JUnit XML, one test per number", 3, OPTION_TEXT, AT(junit)},
    {"markdown", "FILE", "Write a comment for a change; '-' prints it instead of tables", 3,
     OPTION_TEXT, AT(markdown)},
    COMMON_QUIET(3),
};

static bool check_together(void *target, Err *err)
{
    const CheckOptions *options = target;
    if (options->is_blessing && (options->is_quick || options->shake > 0)) {
        return err_set(err, ERR_USAGE,
                       "--bless measures in full and unshaken: it goes with "
                       "neither --quick nor --shake");
    }
    if (options->is_expect_only && (options->is_blessing || options->path_count == 0)) {
        return err_set(err, ERR_USAGE,
                       options->is_blessing ? "--expect-only ignores baselines, and --bless "
                                              "makes one: one of them, not both"
                                            : "--expect-only takes the cases to check");
    }
    if (options->is_blessing && options->common.override_count > 0) {
        return err_set(err, ERR_USAGE,
                       "--bless makes the baseline of a case as its file has it: it does not go "
                       "with --set");
    }
    const bool has_stream = (options->junit != NULL && file_is_stream(options->junit)) ||
                            (options->markdown != NULL && file_is_stream(options->markdown));
    if (options->common.is_json && has_stream) {
        return err_set(err, ERR_USAGE,
                       "--json prints its object alone: give --junit and --markdown files");
    }
    return true;
}

const Arguments CHECK_ARGUMENTS = {
    .program = "jointplay check",
    .usage = "[CASE...]",
    .doc = "Compares the numbers of cases with their baselines and with the limits that the cases "
           "set themselves (expect:). Numbers outside their band are named, and the exit status is "
           "1. Without a case, all cases that have a baseline are checked."
           "\vA baseline that is missing, damaged or of another case is an error; a case that "
           "sets limits needs none.",
    .argument = {.type = OPTION_LIST,
                 AT(paths),
                 .count_offset = offsetof(CheckOptions, path_count),
                 .high = CHECK_PATH_MAX,
                 .what = "cases"},
    OPTION_ROWS(OPTIONS),
    .check = check_together,
};

void check_options_init(CheckOptions *options)
{
    *options = (CheckOptions){.folder = DEFAULT_FOLDER,
                              .common.jobs = common_options_count_jobs(),
                              .common.time_limit_s = DEFAULT_TIME_LIMIT};
}

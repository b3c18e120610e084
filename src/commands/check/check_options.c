// What was `jointplay check` asked for?
#include "commands/check/check_options.h"

#include "cli/arguments.h"
#include "write/file.h"

enum {
    KEY_BASELINES = 0x300, // options without a letter of their own
    KEY_BLESS,
    KEY_QUICK,
    KEY_EXPECT_ONLY,
    KEY_ALL,
    KEY_SHAKE,
    KEY_JUNIT,
    KEY_MARKDOWN,
};

static const char DEFAULT_FOLDER[] = "results/baseline";
static const double DEFAULT_TIME_LIMIT = 600.0; // s: some hundred times the longest usual start
enum { SHAKE_MAX = 1000000 };

static const struct argp_option OPTIONS[] = {
    {"baselines", KEY_BASELINES, "DIR", 0, "Where the baselines are (default: results/baseline)",
     1},
    {"bless", KEY_BLESS, NULL, 0, "Make the baselines of what is measured now, and say what moved",
     1},
    {"quick", KEY_QUICK, NULL, 0, "One run a case: no ensembles, no orders", 1},
    {"expect-only", KEY_EXPECT_ONLY, NULL, 0,
     "Judge cases by their own limits (expect:) and not by baselines", 1},
    {"set", COMMON_SET, "KEY=VALUE", 0, "Replace a value of the cases; may be given often", 1},
    {"shake", KEY_SHAKE, "SEED", 0,
     "Round every input anew first, as another machine might: a way to test bands", 1},
    {"jobs", COMMON_JOBS, "N", 0, "Starts at a time (default: one a core)", 2},
    {"time-limit", COMMON_TIME_LIMIT, "TIME", 0,
     "A start that takes longer has failed (default: 600 s)", 2},
    {"all", KEY_ALL, NULL, 0, "Every number in the tables, not the worst alone", 3},
    COMMON_ROW_JSON(3),
    COMMON_ROW_WIDE(3),
    {"junit", KEY_JUNIT, "FILE", 0, "Write JUnit XML, a test a number", 3},
    {"markdown", KEY_MARKDOWN, "FILE", 0,
     "Write a comment for a change; '-' prints it instead of tables", 3},
    COMMON_ROW_QUIET(3),
    {0},
};

static bool take_case(CheckOptions *options, const char *path, Err *err)
{
    if (options->path_count == CHECK_PATH_MAX) {
        return err_set(err, ERR_USAGE, "more than %d cases on one command line", CHECK_PATH_MAX);
    }
    options->paths[options->path_count++] = path;
    return true;
}

static bool take_shake(CheckOptions *options, const char *value, Err *err)
{
    size_t seed;
    if (!option_values_read_count("shake", value, 1, SHAKE_MAX, &seed, err)) {
        return false;
    }
    options->shake = (unsigned)seed;
    return true;
}

static bool take_option(int key, const char *value, void *target, Err *err)
{
    CheckOptions *options = target;
    switch (key) {
    case KEY_BASELINES:
        options->folder = value;
        return true;
    case KEY_BLESS:
        options->is_blessing = true;
        return true;
    case KEY_QUICK:
        options->is_quick = true;
        return true;
    case KEY_EXPECT_ONLY:
        options->is_expect_only = true;
        return true;
    case KEY_ALL:
        options->is_all = true;
        return true;
    case KEY_SHAKE:
        return take_shake(options, value, err);
    case KEY_JUNIT:
        options->junit = value;
        return true;
    case KEY_MARKDOWN:
        options->markdown = value;
        return true;
    case ARGP_KEY_ARG:
        return take_case(options, value, err);
    default:
        return common_options_take(key, value, &options->common, err);
    }
}

static bool check_together(const CheckOptions *options, Err *err)
{
    if (options->is_blessing && (options->is_quick || options->shake > 0)) {
        return err_set(err, ERR_USAGE,
                       "--bless measures in full and unshaken: it goes with "
                       "neither --quick nor --shake");
    }
    if (options->is_expect_only && (options->is_blessing || options->path_count == 0)) {
        return err_set(err, ERR_USAGE,
                       options->is_blessing ? "--expect-only looks at no baseline, and --bless "
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

bool check_options_read(int argc, char **argv, CheckOptions *options, bool *is_answered, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay check",
        .usage = "[CASE...]",
        .doc = "Holds the numbers of cases against their baselines and against the limits that the "
               "cases set themselves (expect:): every number in its band, or exit status 1 and its "
               "name. Without a case, all that have a baseline."
               "\vA baseline that is missing, damaged or of another case is an error; a case that "
               "sets limits needs none.",
        .options = OPTIONS,
        .take = take_option,
    };
    *options = (CheckOptions){.folder = DEFAULT_FOLDER,
                              .common.jobs = option_values_count_jobs(),
                              .common.time_limit_s = DEFAULT_TIME_LIMIT};
    return arguments_parse(&ARGUMENTS, argc, argv, options, is_answered, err) &&
           (*is_answered || check_together(options, err));
}

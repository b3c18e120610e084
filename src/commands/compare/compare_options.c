// What was `jointplay compare` asked for?
#include "commands/compare/compare_options.h"

#include "cli/arguments.h"
#include "cli/option_values.h"

enum {
    KEY_STEPS = 0x200, // options without a letter of their own
    KEY_REPEATS,
    KEY_STORE,
    KEY_FRESH,
    KEY_CSV,
    KEY_PLOT,
};

// three decades, from where a steel contact is hardly seen; the fine end is thinner, for it costs
// most
static const double DEFAULT_STEPS[] = {3e-5, 2e-5, 1e-5, 5e-6, 3e-6, 2e-6,
                                       1e-6, 5e-7, 3e-7, 1e-7, 3e-8};
static const double DEFAULT_TIME_LIMIT = 600.0; // s: some hundred times the longest usual run

static const struct argp_option OPTIONS[] = {
    {"steps", KEY_STEPS, "LIST", 0, "The steps, such as '10 us, 3 us, 1 us' (default: 30 to 0.03)",
     1},
    COMMON_ROW_SCHEMES(1),
    COMMON_ROW_SET(1),
    {"repeats", KEY_REPEATS, "N", 0, "Timing runs of each point, at least 5 (default: 5)", 2},
    {"jobs", COMMON_JOBS, "N", 0,
     "Error runs at a time (default: one a core); timing runs always go one by one", 2},
    {"time-limit", COMMON_TIME_LIMIT, "TIME", 0,
     "A run that takes longer has failed (default: 600 s)", 2},
    {"store", KEY_STORE, "FILE", 0, "Keep finished runs here and take them from here", 2},
    {"fresh", KEY_FRESH, NULL, 0, "Forget what the store holds", 2},
    COMMON_ROW_JSON(3),
    COMMON_ROW_WIDE(3),
    {"csv", KEY_CSV, "FILE.csv", 0, "Write a row a point", 3},
    {"plot", KEY_PLOT, "FILE.svg", 0, "Draw error over wall time", 3},
    {"out", COMMON_OUT, "DIR", 0, "Write <case>-compare.json, .txt, .csv and .svg there", 3},
    COMMON_ROW_QUIET(3),
    {0},
};

static bool take_option(int key, const char *value, void *target, Err *err)
{
    CompareOptions *options = target;
    switch (key) {
    case KEY_STEPS:
        options->steps = value;
        return true;
    case KEY_REPEATS:
        return option_values_read_count("repeats", value, LADDER_REPEAT_LEAST, LADDER_REPEAT_MAX,
                                        &options->repeats, err);
    case KEY_STORE:
        options->store = value;
        return true;
    case KEY_FRESH:
        options->is_fresh = true;
        return true;
    case KEY_CSV:
        options->csv = value;
        return true;
    case KEY_PLOT:
        options->plot = value;
        return true;
    case ARGP_KEY_ARG:
        return common_options_take_path(value, &options->common, "compare takes one case", err);
    default:
        return common_options_take(key, value, &options->common, err);
    }
}

bool compare_options_read(int argc, char **argv, CompareOptions *options, bool *is_answered,
                          Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay compare",
        .usage = "CASE",
        .doc = "Runs every scheme of ODE over a ladder of steps and prints speed against error, "
               "the frontier, the order observed and the cheapest setting."
               "\vFinished runs are kept in a store under $XDG_CACHE_HOME or ~/.cache: whoever "
               "ends the program at any moment goes on where it stood.",
        .options = OPTIONS,
        .take = take_option,
    };
    *options = (CompareOptions){.repeats = LADDER_REPEAT_LEAST,
                                .common.jobs = option_values_count_jobs(),
                                .common.time_limit_s = DEFAULT_TIME_LIMIT};
    if (!arguments_parse(&ARGUMENTS, argc, argv, options, is_answered, err)) {
        return false;
    }
    if (*is_answered) {
        return true;
    }
    if (!option_values_check_picture("--plot", options->plot, err)) {
        return false;
    }
    return options->common.path != NULL ||
           err_set(err, ERR_USAGE, "no case given: jointplay compare CASE.yaml");
}

static bool check_step(const CompareOptions *options, double step_s, Err *err)
{
    return option_values_check_step(options->common.path, options->common.overrides,
                                    options->common.override_count, step_s, err);
}

static bool read_steps(const CompareOptions *options, double *steps, size_t *count, Err *err)
{
    if (!option_values_read_times("steps", options->steps, LADDER_STEP_MAX, steps, count, err)) {
        return false;
    }
    for (size_t i = 0; i < *count; i++) {
        if (!check_step(options, steps[i], err)) {
            return false;
        }
    }
    return true;
}

// Those of the usual steps that the scenario can be run at; its own where that is none.
static size_t usual_steps(const CompareOptions *options, const Scenario *scenario, double *steps)
{
    size_t count = 0;
    for (size_t i = 0; i < sizeof DEFAULT_STEPS / sizeof DEFAULT_STEPS[0]; i++) {
        Err err = {0};
        if (check_step(options, DEFAULT_STEPS[i], &err)) {
            steps[count++] = DEFAULT_STEPS[i];
        }
    }
    if (count == 0) {
        steps[count++] = scenario->run.step;
    }
    return count;
}

bool compare_options_ladder(const CompareOptions *options, const Scenario *scenario,
                            Ladder **ladder, Err *err)
{
    if (!scheme_check(scenario, err)) {
        return false;
    }
    Scheme schemes[SCHEME_MAX];
    size_t scheme_count;
    double steps[LADDER_STEP_MAX];
    size_t step_count;
    if (!common_options_list_schemes(&options->common, scenario, schemes, &scheme_count, err)) {
        return false;
    }
    if (options->steps == NULL) {
        step_count = usual_steps(options, scenario, steps);
    } else if (!read_steps(options, steps, &step_count, err)) {
        return false;
    }
    *ladder = ladder_create(schemes, scheme_count, steps, step_count, options->repeats);
    return true;
}

// What was `jointplay compare` asked for?
#include "commands/compare/compare_options.h"

#include "cli/option_values.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// The usual steps, of runs as long as one revolution of the paper's crank, s: three decades, from
// where a steel contact is hardly seen; the fine end is thinner, for it costs most. Of longer runs
// they are longer by powers of ten.
static const double DEFAULT_STEPS[] = {3e-5, 2e-5, 1e-5, 5e-6, 3e-6, 2e-6,
                                       1e-6, 5e-7, 3e-7, 1e-7, 3e-8};
static const double DEFAULT_DURATION = 0.06;

// World steps of a run at a usual step, at most: all schemes, five times each, take some minutes.
static const double DEFAULT_STEPS_MOST = 1e6;
static const double DEFAULT_TIME_LIMIT = 600.0; // s: some hundred times the longest usual run

#define AT(field) .offset = offsetof(CompareOptions, field)

static const OptionRow OPTIONS[] = {
    {"steps", "LIST",
     "The steps, such as '10 us, 3 us, 1 us' (default: up to eleven, of some 2000 to "
     "1,000,000 steps in the run)",
     1, OPTION_TEXT, AT(steps)},
    COMMON_SCHEMES(1),
    COMMON_SET(1),
    {"repeats", "N", "Timing runs of each point, at least 5 (default: 5)", 2, OPTION_COUNT,
     AT(repeats), .low = LADDER_REPEAT_LEAST, .high = LADDER_REPEAT_MAX},
    COMMON_JOBS(2,
                "Error runs at a time (default: one per core); timing runs always go one by one"),
    COMMON_TIME_LIMIT(2, "A run that takes longer has failed (default: 600 s)"),
    {"store", "FILE", "Where finished runs are stored and read from", 2, OPTION_TEXT, AT(store)},
    {"fresh", NULL, "Discard the contents of the store", 2, OPTION_FLAG, AT(is_fresh)},
    COMMON_JSON(3),
    COMMON_WIDE(3),
    {"csv", "FILE.csv", "Write one row per point", 3, OPTION_TEXT, AT(csv)},
    {"plot", "FILE.svg", "Draw error over wall time", 3, OPTION_PICTURE, AT(plot)},
    COMMON_OUT(3, "Write <case>-compare.json, .txt, .csv and .svg there"),
    COMMON_QUIET(3),
};

static bool check(void *options, Err *err)
{
    return ((const CompareOptions *)options)->common.path != NULL ||
           err_set(err, ERR_USAGE, "no case given: jointplay compare CASE.yaml");
}

const Arguments COMPARE_ARGUMENTS = {
    .program = "jointplay compare",
    .usage = "CASE",
    .doc = "Runs every scheme of ODE over a ladder of steps and prints speed against error, "
           "the frontier, the order observed and the cheapest setting."
           "\vFinished runs are kept in a store under $XDG_CACHE_HOME or ~/.cache; a "
           "comparison that is stopped at any moment resumes from there.",
    .argument = COMMON_PATH("compare takes one case"),
    OPTION_ROWS(OPTIONS),
    .check = check,
};

CompareOptions compare_options_default(void)
{
    return (CompareOptions){.repeats = LADDER_REPEAT_LEAST,
                            .common.jobs = common_options_count_jobs(),
                            .common.time_limit_s = DEFAULT_TIME_LIMIT};
}

static bool read_steps(const CompareOptions *options, double *steps, size_t *count, Err *err)
{
    if (!option_values_read_times("steps", options->steps, LADDER_STEP_MAX, steps, count, err)) {
        return false;
    }
    for (size_t i = 0; i < *count; i++) {
        if (!common_options_check_step(&options->common, steps[i], err)) {
            return false;
        }
    }
    return true;
}

// To the digits of the usual steps.
static double rounded(double step_s)
{
    char digits[32];
    snprintf(digits, sizeof digits, "%.0e", step_s);
    return strtod(digits, NULL);
}

static double step_factor(const Scenario *scenario)
{
    return pow(10.0, fmax(0.0, ceil(log10(scenario_duration(scenario) / DEFAULT_DURATION) - 0.5)));
}

// Those of the usual steps that the scenario can be run at; its own where that is none.
static size_t usual_steps(const CompareOptions *options, const Scenario *scenario, double *steps)
{
    size_t count = 0;
    for (size_t i = 0; i < sizeof DEFAULT_STEPS / sizeof DEFAULT_STEPS[0]; i++) {
        Err err = {0};
        const double step_s = rounded(step_factor(scenario) * DEFAULT_STEPS[i]);
        if (scenario_duration(scenario) <= DEFAULT_STEPS_MOST * step_s &&
            common_options_check_step(&options->common, step_s, &err)) {
            steps[count++] = step_s;
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

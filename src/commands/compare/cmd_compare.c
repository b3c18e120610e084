// The command `jointplay compare`: its options, its flow and its progress.
#include "base/text.h"
#include "cli/interrupt.h"
#include "cli/long_work.h"
#include "cli/option_values.h"
#include "cli/output.h"
#include "cli/results.h"
#include "cli/warnings.h"
#include "commands/commands.h"
#include "commands/compare/compare.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The options.

// The usual steps, of runs as long as one revolution of the paper's crank, s: three decades, from
// where a steel contact is hardly seen; the fine end is thinner, for it costs most. Of longer runs
// they are longer by powers of ten.
static const double DEFAULT_STEPS[] = {3e-5, 2e-5, 1e-5, 5e-6, 3e-6, 2e-6,
                                       1e-6, 5e-7, 3e-7, 1e-7, 3e-8};
static const double DEFAULT_DURATION = 0.06;

// World steps of a run at a usual step, at most: all schemes, five times each, take some minutes.
static const double DEFAULT_STEPS_MOST = 1e6;

// World steps of all runs together at the usual steps: half a minute to a minute. They are counted
// and not timed, so that a case has the same ladder everywhere.
static const double DEFAULT_WORK_MOST = 1e7;

static const char ALL_STEPS[] = "all";          // of --steps: the usual steps, whatever they take
static const double DEFAULT_TIME_LIMIT = 600.0; // s: some hundred times the longest usual run

#define AT(field) .offset = offsetof(CompareOptions, field)

static const OptionRow COMPARE_OPTIONS[] = {
    {"steps", "LIST",
     "The steps, such as '10 us, 3 us, 1 us', or all: up to eleven, of some 2000 to 1,000,000 "
     "steps in the run (default: those of them that take a minute together, but for a scheme's "
     "finer ones that cannot come to the frontier)",
     1, OPTION_TEXT, AT(steps)},
    COMMON_SCHEMES(1),
    {"backends", "LIST",
     "Engines to compare, such as ode,mujoco or ode,mujoco/kernel+force with some of its ways "
     "(default: ode)",
     1, OPTION_TEXT, AT(backends)},
    {"driver", "NAME=PROGRAM", "A program that runs cases on another engine; may be given often", 1,
     OPTION_LIST, AT(drivers), .what = "drivers",
     .count_offset = offsetof(CompareOptions, driver_count), .high = ENGINE_DRIVER_MAX},
    COMMON_SET(1),
    {"repeats", "N",
     "Timing runs of each point, at least 5 (default: 3, or 5 where times are uneven)", 2,
     OPTION_COUNT, AT(repeats), .low = LADDER_REPEAT_LEAST, .high = LADDER_REPEAT_MAX},
    COMMON_JOBS(2,
                "Error runs at a time (default: one per core); timing runs always go one by one"),
    COMMON_TIME_LIMIT(2, "A run that takes longer has failed (default: 600 s)"),
    {"store", "FILE", "Where finished runs are stored and read from", 2, OPTION_TEXT, AT(store)},
    {"fresh", NULL, "Discard the contents of the store", 2, OPTION_FLAG, AT(is_fresh)},
    COMMON_JSON(3),
    COMMON_FULL(3),
    COMMON_WIDE(3),
    {"csv", "FILE.csv", "Write one row per point", 3, OPTION_TEXT, AT(csv)},
    {"plot", "FILE.svg", "Draw error over wall time", 3, OPTION_PICTURE, AT(plot)},
    COMMON_OUT(3, "Write <case>-compare.json, .txt, .csv and .svg there"),
    COMMON_QUIET(3),
};
#undef AT

static bool cmd_compare_check(void *options, Err *err)
{
    return ((const CompareOptions *)options)->common.path != NULL ||
           err_set(err, ERR_USAGE, "no case given: jointplay compare CASE.yaml");
}

const Arguments COMPARE_ARGUMENTS = {
    .program = "jointplay compare",
    .usage = "CASE",
    .doc = "Runs every scheme of ODE over a ladder of steps and prints speed against error, "
           "the frontier, the order observed and the cheapest setting; with --backends those of "
           "other engines, too."
           "\vFinished runs are kept in a store under $XDG_CACHE_HOME or ~/.cache; a "
           "comparison that is stopped at any moment resumes from there. Drivers of other engines "
           "are programs jointplay-NAME in libexec/jointplay, or in the folder that "
           "JOINTPLAY_DRIVERS names.",
    .argument = COMMON_PATH("compare takes one case"),
    OPTION_ROWS(COMPARE_OPTIONS),
    .check = cmd_compare_check,
};

static CompareOptions compare_options_default(void)
{
    return (CompareOptions){.common.jobs = common_options_count_jobs(),
                            .common.time_limit_s = DEFAULT_TIME_LIMIT};
}

static bool cmd_compare_read_steps(const CompareOptions *options, double *steps, size_t *count,
                                   Err *err)
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
static double cmd_compare_rounded(double step_s)
{
    char digits[32];
    snprintf(digits, sizeof digits, "%.0e", step_s);
    return strtod(digits, NULL);
}

static double step_factor(const Scenario *scenario)
{
    return pow(10.0, fmax(0.0, ceil(log10(scenario_duration(scenario) / DEFAULT_DURATION) - 0.5)));
}

static size_t repeats_of(const CompareOptions *options)
{
    return options->repeats > 0 ? options->repeats : LADDER_REPEAT_LEAST;
}

// World steps of all runs at a step: of each scheme one for the error and the timing runs.
static double work_of(const CompareOptions *options, const Scenario *scenario, size_t schemes,
                      double step_s)
{
    return (double)(schemes * (1 + repeats_of(options))) * scenario_duration(scenario) / step_s;
}

// How many of the steps, coarse to fine, are within the work allowed; at least one. Says what the
// finer ones would take.
static size_t affordable_steps(const CompareOptions *options, const Scenario *scenario,
                               size_t schemes, const double *steps, size_t count, LadderLeft *left)
{
    double work = 0.0;
    double whole = 0.0;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        whole += work_of(options, scenario, schemes, steps[i]);
        if (kept == i && (i == 0 || whole <= DEFAULT_WORK_MOST)) {
            work = whole;
            kept++;
        }
    }
    *left = (LadderLeft){.finest_s = kept < count ? steps[count - 1] : 0.0, .ratio = whole / work};
    return kept;
}

// Those of the usual steps that the scenario can be run at; its own where that is none.
static size_t usual_steps(const CompareOptions *options, const Scenario *scenario, double *steps)
{
    size_t count = 0;
    for (size_t i = 0; i < sizeof DEFAULT_STEPS / sizeof DEFAULT_STEPS[0]; i++) {
        Err err = {0};
        const double step_s = cmd_compare_rounded(step_factor(scenario) * DEFAULT_STEPS[i]);
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

// The ladder that the options ask for: schemes of the scenario, steps coarse to fine. Fails with
// ERR_USAGE for a step that is none or that the scenario cannot be run at.
static bool compare_options_ladder(const CompareOptions *options, const CompareEngines *engines,
                                   const Scenario *scenario, Ladder **ladder, LadderLeft *left,
                                   Err *err)
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
    compare_engines_apply(engines, schemes, &scheme_count);
    *left = (LadderLeft){.finest_s = 0.0};
    if (options->steps == NULL || strcmp(options->steps, ALL_STEPS) == 0) {
        step_count = usual_steps(options, scenario, steps);
        if (options->steps == NULL) {
            step_count = affordable_steps(options, scenario, scheme_count, steps, step_count, left);
        }
    } else if (!cmd_compare_read_steps(options, steps, &step_count, err)) {
        return false;
    }
    *ladder = ladder_create(schemes, scheme_count, steps, step_count, repeats_of(options));
    (*ladder)->samples = scenario_sample_count(scenario);
    (*ladder)->is_whole = options->steps != NULL || options->repeats > 0;
    return true;
}

// The progress.

static const double US = 1e6; // us in a second

CompareProgress compare_progress_start(const Ladder *ladder, size_t jobs, bool is_quiet)
{
    return (CompareProgress){.ladder = ladder, .jobs = jobs, .line = status_line_start(is_quiet)};
}

// How many of the steps, from the coarsest on, take no longer than what is not announced.
static size_t count_quick_steps(const CompareProgress *progress, double limit_s)
{
    size_t count = 0;
    while (count < progress->ladder->step_count &&
           ladder_time_of_steps(progress->ladder, count + 1, progress->jobs) <= limit_s) {
        count++;
    }
    return count;
}

static void append_way_out(const CompareProgress *progress, double limit_s, Text *words)
{
    const Ladder *ladder = progress->ladder;
    const size_t count = count_quick_steps(progress, limit_s);
    if (count == 0) {
        text_append(words, "; fewer --schemes or longer --steps take less");
        return;
    }
    text_append(words, "; --steps '");
    for (size_t i = 0; i < count; i++) {
        text_append(words, "%s%.4g us", i > 0 ? ", " : "", US * ladder->steps[i]);
    }
    char time[LONG_WORK_TIME_SIZE];
    long_work_time(ladder_time_of_steps(ladder, count, progress->jobs), time);
    text_append(words, "' %s about %s, fewer --schemes less as well", count > 1 ? "take" : "takes",
                time);
}

static void announce(CompareProgress *progress, double left_s)
{
    const Ladder *ladder = progress->ladder;
    const double limit_s = long_work_limit(progress->line.is_quiet);
    if (progress->is_announced || !ladder_has_pace(ladder)) {
        return;
    }
    progress->is_announced = true;
    if (left_s <= limit_s) {
        return;
    }
    char time[LONG_WORK_TIME_SIZE];
    long_work_time(left_s, time);
    Text words;
    text_init(&words);
    text_append(&words, "the %zu runs left take about %s",
                ladder_run_total(ladder) - ladder_run_done(ladder), time);
    append_way_out(progress, limit_s, &words);
    status_line_end(&progress->line);
    output_say("jointplay: warning: %s\n", words.data);
    progress->line.is_warned = true;
    text_finish(&words);
}

void compare_progress_show(CompareProgress *progress, const char *doing)
{
    const double wall_s = status_line_time(&progress->line);
    const double left_s = ladder_time_left(progress->ladder, progress->jobs);
    announce(progress, left_s);
    if (!status_line_is_due(&progress->line, wall_s, left_s > 0.0 ? left_s : INFINITY)) {
        return;
    }
    Text words;
    text_init(&words);
    text_append(&words, "%s: %zu of %zu runs, %.0f s", doing, ladder_run_done(progress->ladder),
                ladder_run_total(progress->ladder), wall_s);
    status_line_append_left(&words, left_s);
    status_line_show(&progress->line, words.data);
    text_finish(&words);
}

void compare_progress_end(CompareProgress *progress)
{
    status_line_end(&progress->line);
}

// The store keeps, the progress watches.
typedef struct Listening {
    CompareStore store;
    CompareProgress progress;
} Listening;

static bool keep_truth(const LadderTruth *truth, void *context, Err *err)
{
    return compare_store_keep_truth(truth, &((Listening *)context)->store, err);
}

static bool keep_run(const LadderRun *run, void *context, Err *err)
{
    return compare_store_keep_run(run, &((Listening *)context)->store, err);
}

static bool keep_ensemble(size_t scheme, const LadderEnsemble *ensemble, void *context, Err *err)
{
    return compare_store_keep_ensemble(scheme, ensemble, &((Listening *)context)->store, err);
}

static void cmd_compare_wait(const char *doing, void *context)
{
    compare_progress_show(&((Listening *)context)->progress, doing);
}

static bool cmd_compare_should_stop(void *context)
{
    (void)context;
    return interrupt_number() != 0;
}

// Ends by the signal that stopped the work.
static void end_stopped(const CompareOptions *options, const Ladder *ladder, CompareStore *store)
{
    if (!options->common.is_quiet) {
        output_say("stopped; %zu of %zu runs are kept in %s, and the same command%s goes on from "
                   "there\n",
                   ladder_run_made(ladder), ladder_run_total(ladder), store->journal.path,
                   options->is_fresh ? " without --fresh" : "");
    }
    compare_store_close(store);
    interrupt_obey();
}

static const ResultFile COMPARE_FILES[] = {
    {.ending = ".txt", .kind = FILE_REPORT},
    {"--csv", offsetof(CompareOptions, csv), ".csv", FILE_TABLE, .write = compare_rows_write_csv},
    {"--plot", offsetof(CompareOptions, plot), ".svg", FILE_PICTURE, .text = compare_plot_write},
    {.ending = ".json", .kind = FILE_RESULT},
};

static const Results COMPARE_RESULTS = {
    .suffix = "-compare",
    .is_followed = true,
    .json = compare_json_build,
    .text = compare_text_write,
    .screen = compare_screen_write,
    RESULT_FILES(COMPARE_FILES),
};

// A point that fails is a result; a comparison in which every one of ODE's fails is none.
static bool check_points(const Ladder *ladder, Err *err)
{
    const LadderPoint *failed = NULL;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->step_s > 0.0 && !point->is_failed) {
            return true;
        }
        failed = point->step_s > 0.0 && failed == NULL ? point : failed;
    }
    return failed == NULL || err_set(err, ERR_SOLVER, "every run%s failed: %s at %.4g us: %s",
                                     compare_engines_are_any(ladder) ? "" : " of ODE", failed->name,
                                     1e6 * failed->step_s, failed->reason);
}

static bool compare_ladder(const CompareOptions *options, const Scenario *scenario, Ladder *ladder,
                           LadderLeft left, Err *err)
{
    Listening listening = {
        .progress = compare_progress_start(ladder, options->common.jobs, options->common.is_quiet)};
    const Runner runner = {
        .ladder = ladder,
        .scenario = scenario,
        .jobs = options->common.jobs,
        .time_limit_s = options->common.time_limit_s,
        .listener = {keep_truth, keep_run, keep_ensemble, cmd_compare_wait, cmd_compare_should_stop,
                     &listening},
    };
    interrupt_watch();
    const bool is_run = compare_store_open(&listening.store, options, scenario, ladder, err) &&
                        runner_execute(&runner, err);
    compare_progress_end(&listening.progress);
    if (!is_run && interrupt_number() != 0) {
        end_stopped(options, ladder, &listening.store);
    }
    compare_store_close(&listening.store);
    if (!is_run) {
        return false;
    }
    ladder_conclude(ladder);
    const CompareReport report = {scenario, ladder, listening.store.machine, left};
    results_print(&COMPARE_RESULTS, &options->common, &report);
    return results_write(&COMPARE_RESULTS, &options->common, scenario_path(scenario), &report,
                         err) &&
           check_points(ladder, err);
}

// Warns of the settings that no scheme and no truth makes use of.
static void cmd_compare_warn(const CompareOptions *options, const Scenario *scenario)
{
    // a comparison runs all backends and both solvers of ODE, whatever the case says
    Scenario *whole = malloc(sizeof *whole);
    assert(whole != NULL);
    *whole = *scenario;
    whole->run.backend_count = BACKEND_COUNT;
    for (int i = 0; i < BACKEND_COUNT; i++) {
        whole->run.backends[i] = (BackendKind)i;
    }
    whole->ode.solver = ODE_QUICK;
    warnings_say(whole, &options->common);
    free(whole);
}

static bool compare_case(void *target, Err *err)
{
    const CompareOptions *options = target;
    Ladder *ladder = NULL;
    LadderLeft left = {.finest_s = 0.0};
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    CompareEngines *engines = compare_engines_read(options, err);
    bool is_done = engines != NULL && common_options_read(&options->common, scenario, err) &&
                   compare_engines_check(engines, scenario, options->common.time_limit_s, err);
    if (is_done) {
        common_options_settle(&options->common, scenario);
        is_done = compare_options_ladder(options, engines, scenario, &ladder, &left, err) &&
                  results_claim(&COMPARE_RESULTS, &options->common, scenario_path(scenario), err);
    }
    if (is_done) {
        cmd_compare_warn(options, scenario);
        is_done = compare_ladder(options, scenario, ladder, left, err);
    }
    ladder_destroy(ladder);
    scenario_destroy(scenario);
    free(engines);
    return is_done;
}

static bool compare_run(int argc, char **argv, Err *err)
{
    CompareOptions options = compare_options_default();
    return arguments_run(&COMPARE_ARGUMENTS, argc, argv, &options, compare_case, err);
}

const Command cmd_compare = {
    .name = "compare",
    .summary = "speed against error: every scheme over a ladder of steps",
    .run = compare_run,
    .arguments = &COMPARE_ARGUMENTS,
};

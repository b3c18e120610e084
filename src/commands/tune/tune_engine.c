// Searches the cheapest setting of another engine that meets an error.
//
// Steps fall by 1, 0.5, 0.2, 0.1, ... from a two-hundredth of a turn until a way meets the error,
// its run fails for another reason than its step, or takes longer than the cheapest that is known.
// The coarsest is taken, and timed by the median of three runs.
#include "commands/tune/tune_engine.h"

#include "base/sorted.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "measure/error.h"
#include "measure/truth.h"
#include "write/json_value.h"
#include "write/settings_json.h"
#include "write/table.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    STEP_COUNT = 16, // from a two-hundredth of a turn over five decades
    REPEATS = 3,
};

static const double FIRST_SHARE = 200.0;       // steps of a turn, or of the run
static const double FALLS[] = {1.0, 0.5, 0.2}; // of a decade
static const double SLOW_S = 10.0;             // a way is given up whose run takes longer
static const double DEFAULT_LIMIT_S = 60.0;    // of one run

typedef struct EngineTrial {
    size_t way;
    double step_s;
    double error; // 1; NAN where the run failed
    double wall_s;
    size_t steps;
    bool is_refused; // the driver does not take the case in that way
    char message[ERR_TEXT_SIZE];
} EngineTrial;

typedef struct EngineTune {
    const TuneEngineOptions *options;
    const Scenario *scenario;
    EngineDriver driver;
    Scheme ways[SCHEME_ENGINE_MAX];
    size_t way_count;
    Truth truth;
    EngineTrial trials[ENGINE_WAY_MAX * STEP_COUNT];
    size_t trial_count;
    const EngineTrial *best; // NULL: none meets the target
} EngineTune;

static bool find_engine(EngineTune *tune, Err *err)
{
    const CommonOptions *common = tune->options->common;
    char name[ENGINE_NAME_SIZE];
    const size_t length = strcspn(tune->options->engine, "/");
    const char *ways =
        tune->options->engine[length] == '/' ? tune->options->engine + length + 1 : NULL;
    snprintf(name, sizeof name, "%.*s", (int)length, tune->options->engine);
    for (size_t i = 0; i < common->driver_count; i++) {
        if (strncmp(common->drivers[i], name, strlen(name)) == 0 &&
            common->drivers[i][strlen(name)] == '=') {
            return engine_given(common->drivers[i], &tune->driver, err) &&
                   scheme_add_engine(&tune->driver, ways, tune->ways, &tune->way_count, err);
        }
    }
    return engine_find(name, &tune->driver, err) &&
           scheme_add_engine(&tune->driver, ways, tune->ways, &tune->way_count, err);
}

static double limit_of(const EngineTune *tune)
{
    const double asked_s = tune->options->common->time_limit_s;
    return asked_s > 0.0 ? asked_s : DEFAULT_LIMIT_S;
}

static Trajectory *run_at(const EngineTune *tune, size_t way, double step_s, EngineSaid *said)
{
    Scenario scenario = *tune->scenario;
    scenario.run.step = step_s;
    return engine_run(&tune->driver, tune->ways[way].way, &scenario, limit_of(tune), said);
}

// A step, by its number: of one digit.
static double step_of(const EngineTune *tune, size_t number)
{
    const double turn_s = linkage_period(&tune->scenario->linkage);
    const double whole_s = turn_s > 0.0 ? turn_s : scenario_duration(tune->scenario);
    const double decade = pow(10.0, floor(log10(whole_s / FIRST_SHARE)));
    return decade * FALLS[number % 3] * pow(10.0, -(double)(number / 3));
}

static const EngineTrial *make_trial(EngineTune *tune, size_t way, double step_s)
{
    EngineTrial *trial = &tune->trials[tune->trial_count++];
    EngineSaid said;
    Trajectory *run = run_at(tune, way, step_s, &said);
    *trial = (EngineTrial){.way = way,
                           .step_s = step_s,
                           .error = NAN,
                           .wall_s = run->wall_s,
                           .steps = run->steps,
                           .is_refused = said.is_refused};
    if (run->is_complete) {
        const bool is_limited = tune->truth.is_limited;
        const TrajectoryError error = error_against(run, tune->truth.trajectory,
                                                    is_limited ? tune->truth.horizon_s : INFINITY);
        trial->error = error_of_kind(&error, tune->scenario->run.tolerance_of, is_limited);
    } else {
        text_copy(trial->message, sizeof trial->message, run->message);
    }
    trajectory_destroy(run);
    return trial;
}

static bool meets(const EngineTune *tune, const EngineTrial *trial)
{
    return trial->error + tune->truth.uncertainty <= tune->options->target;
}

// The time of a setting, the median of runs.
static double time_of(const EngineTune *tune, const EngineTrial *trial)
{
    double times[REPEATS] = {trial->wall_s};
    for (size_t i = 1; i < REPEATS; i++) {
        Trajectory *run = run_at(tune, trial->way, trial->step_s, NULL);
        times[i] = run->is_complete ? run->wall_s : INFINITY;
        trajectory_destroy(run);
    }
    sorted_make(times, REPEATS);
    return sorted_median(times, REPEATS);
}

static void search_way(EngineTune *tune, size_t way)
{
    for (size_t i = 0; i < STEP_COUNT; i++) {
        const EngineTrial *trial = make_trial(tune, way, step_of(tune, i));
        if (meets(tune, trial)) {
            EngineTrial *timed = &tune->trials[tune->trial_count - 1];
            timed->wall_s = time_of(tune, trial);
            if (tune->best == NULL || timed->wall_s < tune->best->wall_s) {
                tune->best = timed;
            }
            return;
        }
        // what is refused is so at any step
        if (trial->is_refused || trial->wall_s > SLOW_S ||
            (tune->best != NULL && trial->wall_s > tune->best->wall_s)) {
            return;
        }
    }
}

static void append_best(const EngineTune *tune, Text *text)
{
    const EngineDriver *driver = &tune->driver;
    text_append(text, "  %s %s, in %s precision: ", driver->engine, driver->version,
                driver->precision);
    if (tune->best == NULL) {
        text_append(text, "nothing that was tried meets an error of %.3g.\n",
                    tune->options->target);
        return;
    }
    text_append(text, "%s at a step of %.4g us has an error of %.2g in %.3g ms.\n",
                tune->ways[tune->best->way].name, tune->best->step_s * UNITS_US, tune->best->error,
                tune->best->wall_s * UNITS_MS);
}

static void write_text(const EngineTune *tune, const Style *style)
{
    static const SectionHead HEADS[] = {
        {"way", "", TABLE_LEFT},          {"step", "us", TABLE_RIGHT}, {"error", "1", TABLE_RIGHT},
        {"wall time", "ms", TABLE_RIGHT}, {"", "", TABLE_WRAP},
    };
    Text text;
    text_init(&text);
    append_best(tune, &text);
    Table *table =
        section_begin("What was tried", sizeof HEADS / sizeof *HEADS, HEADS, style, &text);
    for (size_t i = 0; i < tune->trial_count; i++) {
        const EngineTrial *trial = &tune->trials[i];
        table_cell(table, "%s", tune->ways[trial->way].name);
        table_cell(table, "%.4g", trial->step_s * UNITS_US);
        section_finite(table, "%.2e", trial->error);
        section_finite(table, "%.4g", trial->error >= 0.0 ? trial->wall_s * UNITS_MS : NAN);
        table_cell(table, "%s", trial == tune->best ? "the cheapest" : trial->message);
    }
    section_end(table, &text);
    output_text(&text, style);
    text_finish(&text);
}

static json_t *engine_trial_object(const EngineTune *tune, const EngineTrial *trial)
{
    if (trial == NULL) {
        return json_null();
    }
    json_t *object = json_pack("{s:s}", "scheme", tune->ways[trial->way].name);
    json_value_set(object, "step_s", trial->step_s);
    json_value_set(object, "error_max", trial->error);
    json_object_set_new(object, "steps", json_integer((json_int_t)trial->steps));
    json_value_set(object, "wall_s", isfinite(trial->error) ? trial->wall_s : NAN);
    json_object_set_new(object, "message", json_value_text(trial->message));
    return object;
}

static void write_json(const EngineTune *tune)
{
    json_t *object = json_object();
    settings_json_begin(object, tune->scenario);
    json_object_set_new(object, "engine",
                        json_pack("{s:o, s:o, s:o}", "name", json_value_text(tune->driver.engine),
                                  "version", json_value_text(tune->driver.version), "precision",
                                  json_value_text(tune->driver.precision)));
    json_value_set(object, "error_at_most", tune->options->target);
    json_value_set(object, "reference_uncertainty", tune->truth.uncertainty);
    json_object_set_new(object, "cheapest", engine_trial_object(tune, tune->best));
    json_t *trials = json_array();
    for (size_t i = 0; i < tune->trial_count; i++) {
        json_array_append_new(trials, engine_trial_object(tune, &tune->trials[i]));
    }
    json_object_set_new(object, "trials", trials);
    output_json(object);
}

static bool search_steps(EngineTune *tune, Err *err)
{
    const CommonOptions *common = tune->options->common;
    Progress progress;
    progress_begin(&progress, common->is_quiet);
    tune->truth = truth_make(tune->scenario, progress_watch(&progress, "reference"));
    progress_end(&progress);
    if (!tune->truth.trajectory->is_complete) {
        err_set(err, ERR_SOLVER, "%s", tune->truth.trajectory->message);
        truth_finish(&tune->truth);
        return false;
    }
    // drivers name their best ways last: the others are then soon too slow
    for (size_t i = tune->way_count; i-- > 0;) {
        search_way(tune, i);
    }
    if (common->is_json) {
        write_json(tune);
    } else {
        const Style style = output_style(stdout, common->is_wide);
        write_text(tune, &style);
    }
    truth_finish(&tune->truth);
    return tune->best != NULL ||
           err_set(err, ERR_DIFFERS, "no setting of %s that was tried meets an error of %.3g",
                   tune->driver.name, tune->options->target);
}

// Whether the engine is there and takes the case.
static bool check_engine(EngineTune *tune, Err *err)
{
    const char *ways[SCHEME_ENGINE_MAX];
    if (!find_engine(tune, err)) {
        return false;
    }
    for (size_t i = 0; i < tune->way_count; i++) {
        ways[i] = tune->ways[i].way;
    }
    const bool is_taken =
        engine_takes(&tune->driver, ways, tune->way_count, tune->scenario, limit_of(tune), err);
    if (!is_taken) {
        err_prefix(err, scenario_path(tune->scenario));
    }
    return is_taken;
}

bool tune_engine_run(const TuneEngineOptions *options, Scenario *scenario, Err *err)
{
    if (!(options->target > 0.0)) {
        return err_set(err, ERR_USAGE, "--backend needs --error X, such as --error 1e-3");
    }
    EngineTune *tune = calloc(1, sizeof *tune);
    assert(tune != NULL);
    tune->options = options;
    tune->scenario = scenario;
    bool is_done = check_engine(tune, err);
    if (is_done) {
        common_options_settle(options->common, scenario);
        is_done = search_steps(tune, err);
    }
    free(tune);
    return is_done;
}

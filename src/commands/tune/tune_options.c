// What was `jointplay tune` asked for?
#include "commands/tune/tune_options.h"

#include "base/shell.h"
#include "casefile/quantity.h"
#include "cli/arguments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_ERROR = 0x300, // options without a letter of their own
    KEY_MAX_COST,
    KEY_COST,
    KEY_AT_STEP,
    KEY_CODE,
    KEY_SDF,
    KEY_MJCF,
};

// s: what takes longer is no cheap setting, and a search makes many runs
static const double DEFAULT_TIME_LIMIT = 60.0;

// an error of the speeds' own size is none worth asking for
static const double ERROR_MOST = 0.5;
static const double COST_STEPS_MOST = 1e9;

static const struct argp_option OPTIONS[] = {
    {"error", KEY_ERROR, "X", 0,
     "The largest error in omega allowed, relative to each body's largest omega, such as 1e-3", 1},
    {"max-cost", KEY_MAX_COST, "COST", 0,
     "What one run may cost: a time such as '50 ms', or world steps such as 2000", 1},
    {"cost", KEY_COST, "time|steps", 0,
     "What is to be least (default: time, or the unit of --max-cost)", 1},
    {"at-step", KEY_AT_STEP, "TIME", 0,
     "The only step that can be taken, such as '1 ms': the least error there, of every scheme and "
     "of contacts with constants; --error may be left out",
     1},
    COMMON_ROW_SCHEMES(1),
    COMMON_ROW_SET(1),
    {"jobs", COMMON_JOBS, "N", 0,
     "Runs at a time while searching (default: one a core); timing runs always go one by one", 2},
    {"time-limit", COMMON_TIME_LIMIT, "TIME", 0,
     "A run that takes longer is not tried (default: 60 s)", 2},
    {"code", KEY_CODE, "FILE.c", 0, "Write the setting as a C program that needs ODE alone", 3},
    {"sdf", KEY_SDF, "FILE.sdf", 0, "Write the contact as Gazebo can have it", 3},
    {"mjcf", KEY_MJCF, "FILE.xml", 0, "Write the contact as MuJoCo can have it", 3},
    COMMON_ROW_JSON(3),
    COMMON_ROW_WIDE(3),
    {"out", COMMON_OUT, "DIR", 0, "Write <case>-tune.json, .txt, .c, .sdf and .xml there", 3},
    COMMON_ROW_QUIET(3),
    {0},
};

static bool read_error(const char *text, double *error, Err *err)
{
    Complaint complaint;
    double value;
    if (!quantity_number(text, &value, &complaint) || !(value > 0.0) || value > ERROR_MOST) {
        return err_set(err, ERR_USAGE,
                       "--error is %s; allowed: a number above 0, up to %g, such "
                       "as 1e-3",
                       text, ERROR_MOST);
    }
    *error = value;
    return true;
}

// A plain number counts world steps, a time is a time.
static bool read_limit(const char *text, TuneOptions *options, Err *err)
{
    Complaint complaint;
    double time_s;
    size_t steps;
    if (quantity_integer(text, &steps, &complaint) && steps > 0 &&
        (double)steps <= COST_STEPS_MOST) {
        options->limit = (TuneLimit){.steps = steps};
        return true;
    }
    if (quantity_parse(text, DIMENSION_TIME, &time_s, &complaint) && time_s > 0.0) {
        options->limit = (TuneLimit){.time_s = time_s};
        return true;
    }
    return err_set(err, ERR_USAGE,
                   "--max-cost is %s; allowed: a time above 0 such as '50 ms', or a whole number "
                   "of world steps such as 2000",
                   text);
}

static bool read_cost(const char *text, const char **cost, Err *err)
{
    if (strcmp(text, "time") != 0 && strcmp(text, "steps") != 0) {
        return err_set(err, ERR_USAGE, "--cost is %s; allowed: time, steps", text);
    }
    *cost = text;
    return true;
}

// The options, and what has yet to be fitted to others.
typedef struct Reading {
    TuneOptions *options;
    const char *cost;
} Reading;

static bool take_option(int key, const char *value, void *target, Err *err)
{
    Reading *reading = target;
    TuneOptions *options = reading->options;
    switch (key) {
    case KEY_ERROR:
        return read_error(value, &options->error, err);
    case KEY_MAX_COST:
        return read_limit(value, options, err);
    case KEY_COST:
        return read_cost(value, &reading->cost, err);
    case KEY_AT_STEP:
        return option_values_read_time("at-step", value, &options->at_step_s, err);
    case KEY_CODE:
        options->code = value;
        return true;
    case KEY_SDF:
        options->sdf = value;
        return true;
    case KEY_MJCF:
        options->mjcf = value;
        return true;
    case ARGP_KEY_ARG:
        return common_options_take_path(value, &options->common, "tune takes one case", err);
    default:
        return common_options_take(key, value, &options->common, err);
    }
}

// What is to be least must be what is limited: nothing else could be said of it.
static bool settle_cost(const char *cost, TuneOptions *options, Err *err)
{
    const bool has_steps = options->limit.steps > 0;
    options->cost = has_steps ? TUNE_STEPS : TUNE_TIME;
    if (options->at_step_s > 0.0 && (has_steps || options->limit.time_s > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "--max-cost and --at-step do not go together: a step that is held leaves no "
                       "cost to choose");
    }
    if (cost == NULL) {
        return true;
    }
    const TuneCost asked = strcmp(cost, "steps") == 0 ? TUNE_STEPS : TUNE_TIME;
    const bool has_limit = options->limit.steps > 0 || options->limit.time_s > 0.0;
    if (options->at_step_s > 0.0) {
        return err_set(err, ERR_USAGE,
                       "--cost and --at-step do not go together: a step that is held leaves no "
                       "cost to choose");
    }
    if (has_limit && asked != options->cost) {
        return err_set(err, ERR_USAGE, "--cost %s and a --max-cost in %s do not go together", cost,
                       options->cost == TUNE_STEPS ? "steps" : "time");
    }
    options->cost = asked;
    return true;
}

bool tune_options_read(int argc, char **argv, TuneOptions *options, bool *is_answered, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay tune",
        .usage = "CASE",
        .doc = "Searches for the cheapest setting of ODE whose error, found by running it against "
               "the certified reference, meets --error, and prints it as numbers, as ODE C code, "
               "and as far as they go for Gazebo and MuJoCo, with all that was tried."
               "\vExit status 1 says that no setting meets the error, or none within --max-cost.",
        .options = OPTIONS,
        .take = take_option,
    };
    *options = (TuneOptions){.common.jobs = option_values_count_jobs(),
                             .common.time_limit_s = DEFAULT_TIME_LIMIT};
    Reading reading = {.options = options};
    if (!arguments_parse(&ARGUMENTS, argc, argv, &reading, is_answered, err)) {
        return false;
    }
    if (*is_answered) {
        return true;
    }
    if (options->common.path == NULL) {
        return err_set(err, ERR_USAGE, "no case given: jointplay tune CASE.yaml --error 1e-3");
    }
    if (options->error == 0.0 && options->at_step_s == 0.0) {
        char *path = shell_copy_path(options->common.path);
        err_set(err, ERR_USAGE, "no error given: jointplay tune %s --error 1e-3", path);
        free(path);
        return false;
    }
    return settle_cost(reading.cost, options, err);
}

bool tune_options_search(const TuneOptions *options, const Scenario *scenario, Tune **tune,
                         Err *err)
{
    if (!scheme_check(scenario, err)) {
        return false;
    }
    if (scenario->contact.model == CONTACT_POISSON && scenario_has_clearance(scenario)) {
        return err_set(err, ERR_CASE,
                       "contact.model poisson has no spring and no reference of its own: against "
                       "the elastic law its error is that of the model, and no step mends it; "
                       "allowed: contact.model impact");
    }
    const CommonOptions *common = &options->common;
    const bool is_held = options->at_step_s > 0.0;
    Scheme schemes[SCHEME_MAX];
    size_t scheme_count;
    if (!common_options_list_schemes(common, scenario, schemes, &scheme_count, err) ||
        (is_held && !option_values_check_step(common->path, common->overrides,
                                              common->override_count, options->at_step_s, err))) {
        return false;
    }
    Tune *made = tune_create(scenario, schemes, scheme_count,
                             options->error > 0.0 ? options->error : INFINITY);
    made->cost = options->cost;
    made->limit = options->limit;
    if (is_held) {
        tune_hold(made, options->at_step_s);
    }
    if (made->scheme_count == 0) {
        tune_destroy(made);
        return err_set(err, ERR_USAGE,
                       "--schemes %s chooses its steps by itself; --at-step needs one that takes "
                       "the step it is given, such as direct/plain",
                       common->schemes);
    }
    *tune = made;
    return true;
}

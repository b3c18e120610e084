// What was `jointplay tune` asked for?
#include "cli/tune_options.h"

#include "casefile/quantity.h"
#include "cli/arguments.h"
#include "report/file.h"

#include <string.h>

enum {
    KEY_ERROR = 0x300, // options without a letter of their own
    KEY_MAX_COST,
    KEY_COST,
    KEY_SCHEMES,
    KEY_SET,
    KEY_JOBS,
    KEY_TIME_LIMIT,
    KEY_CODE,
    KEY_SDF,
    KEY_MJCF,
    KEY_JSON,
    KEY_OUT,
    KEY_QUIET = 'q',
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
    {"schemes", KEY_SCHEMES, "LIST", 0,
     "Only these schemes of ODE: 'direct/corrected' is every one with both words, 'all' every one",
     1},
    {"set", KEY_SET, "KEY=VALUE", 0,
     "Replace a value of the case, such as contact.restitution=0.8; may be given often", 1},
    {"jobs", KEY_JOBS, "N", 0,
     "Runs at a time while searching (default: one a core); timing runs always go one by one", 2},
    {"time-limit", KEY_TIME_LIMIT, "TIME", 0,
     "A run that takes longer is not tried (default: 60 s)", 2},
    {"code", KEY_CODE, "FILE.c", 0, "Write the setting as a C program that needs ODE alone", 3},
    {"sdf", KEY_SDF, "FILE.sdf", 0, "Write the contact as Gazebo can have it", 3},
    {"mjcf", KEY_MJCF, "FILE.xml", 0, "Write the contact as MuJoCo can have it", 3},
    {"json", KEY_JSON, NULL, 0, "Print one JSON object instead of tables", 3},
    {"out", KEY_OUT, "DIR", 0, "Write <case>-tune.json, .txt, .c, .sdf and .xml there", 3},
    {"quiet", KEY_QUIET, NULL, 0, "Nothing on standard error but errors", 3},
    {0},
};

static bool take_case(TuneOptions *options, const char *path, Err *err)
{
    if (options->path != NULL) {
        return err_set(err, ERR_USAGE, "tune takes one case, not %s and %s", options->path, path);
    }
    options->path = path;
    return true;
}

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
    case KEY_SCHEMES:
        options->schemes = value;
        return true;
    case KEY_SET:
        return option_values_take_setting(value, options->overrides, &options->override_count, err);
    case KEY_JOBS:
        return option_values_read_count("jobs", value, 1, option_values_count_cores(),
                                        &options->jobs, err);
    case KEY_TIME_LIMIT:
        return option_values_read_time("time-limit", value, &options->time_limit_s, err);
    case KEY_CODE:
        options->code = value;
        return true;
    case KEY_SDF:
        options->sdf = value;
        return true;
    case KEY_MJCF:
        options->mjcf = value;
        return true;
    case KEY_JSON:
        options->is_json = true;
        return true;
    case KEY_OUT:
        options->folder = value;
        return true;
    case KEY_QUIET:
        options->is_quiet = true;
        return true;
    default:
        return take_case(options, value, err);
    }
}

// What is to be least must be what is limited: nothing else could be said of it.
static bool settle_cost(const char *cost, TuneOptions *options, Err *err)
{
    options->cost = options->limit.steps > 0 ? TUNE_STEPS : TUNE_TIME;
    if (cost == NULL) {
        return true;
    }
    const TuneCost asked = strcmp(cost, "steps") == 0 ? TUNE_STEPS : TUNE_TIME;
    const bool has_limit = options->limit.steps > 0 || options->limit.time_s > 0.0;
    if (has_limit && asked != options->cost) {
        return err_set(err, ERR_USAGE, "--cost %s and a --max-cost in %s do not go together", cost,
                       options->cost == TUNE_STEPS ? "steps" : "time");
    }
    options->cost = asked;
    return true;
}

static bool check_paths(const TuneOptions *options, Err *err)
{
    const char *const paths[] = {options->code, options->sdf, options->mjcf};
    for (size_t i = 0; i < 3; i++) {
        for (size_t k = i + 1; k < 3; k++) {
            if (file_is_same(paths[i], paths[k])) {
                return err_set(err, ERR_USAGE, "two options would both write %s", paths[i]);
            }
        }
    }
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
    *options =
        (TuneOptions){.jobs = option_values_count_cores(), .time_limit_s = DEFAULT_TIME_LIMIT};
    Reading reading = {.options = options};
    if (!arguments_parse(&ARGUMENTS, argc, argv, &reading, is_answered, err)) {
        return false;
    }
    if (*is_answered) {
        return true;
    }
    if (options->path == NULL) {
        return err_set(err, ERR_USAGE, "no case given: jointplay tune CASE.yaml --error 1e-3");
    }
    if (options->error == 0.0) {
        return err_set(err, ERR_USAGE, "no error given: jointplay tune %s --error 1e-3",
                       options->path);
    }
    return settle_cost(reading.cost, options, err) && check_paths(options, err);
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
    Scheme schemes[SCHEME_MAX];
    size_t scheme_count = scheme_list(scenario, schemes);
    if (options->schemes == NULL) {
        scheme_keep_usual(schemes, &scheme_count);
    } else if (!scheme_filter(options->schemes, schemes, &scheme_count, err)) {
        return false;
    }
    *tune = tune_create(scenario, schemes, scheme_count, options->error);
    (*tune)->cost = options->cost;
    (*tune)->limit = options->limit;
    return true;
}

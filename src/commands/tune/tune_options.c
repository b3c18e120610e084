// What was `jointplay tune` asked for?
#include "commands/tune/tune_options.h"

#include "base/shell.h"
#include "casefile/quantity.h"
#include "cli/output.h"
#include "commands/tune/tune_world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// s: a slower setting is not cheap, and a search makes many runs
static const double DEFAULT_TIME_LIMIT = 60.0;

// errors of the speeds' own size are of no use
static const double ERROR_MOST = 0.5;
static const double COST_STEPS_MOST = 1e9;

static bool read_error(const char *text, void *options, Err *err)
{
    Complaint complaint;
    double value;
    if (!quantity_number(text, &value, &complaint) || !(value > 0.0) || value > ERROR_MOST) {
        return err_set(err, ERR_USAGE,
                       "--error is %s; allowed: a number above 0, up to %g, such as 1e-3", text,
                       ERROR_MOST);
    }
    ((TuneOptions *)options)->error = value;
    return true;
}

// A plain number counts world steps, a time is a time.
static bool read_limit(const char *text, void *target, Err *err)
{
    TuneOptions *options = target;
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

#define AT(field) .offset = offsetof(TuneOptions, field)

static const char *const COSTS[] = {"time", "steps", NULL};

static const OptionRow OPTIONS[] = {
    {"error", "X",
     "The largest error allowed of any rate of the motion, relative to its own largest value, such "
     "as 1e-3",
     1, OPTION_READ, .read = read_error},
    {"max-cost", "COST",
     "What one run may cost: a time such as '50 ms', or world steps such as 2000", 1, OPTION_READ,
     .read = read_limit},
    {"cost", "time|steps", "What to minimise (default: time, or the unit of --max-cost)", 1,
     OPTION_CHOICE, AT(asked_cost), .words = COSTS},
    {"at-step", "TIME",
     "A step that cannot be changed, such as '1 ms': the smallest error at it, of every scheme and "
     "of contacts with constants; --error may be omitted",
     1, OPTION_QUANTITY, AT(at_step_s), .dimension = DIMENSION_TIME},
    COMMON_SCHEMES(1),
    COMMON_SET(1),
    COMMON_JOBS(2, "Runs at a time while searching (default: one per core); timing runs always go "
                   "one by one"),
    COMMON_TIME_LIMIT(2, "A run that takes longer is not tried (default: 60 s)"),
    {"code", "FILE.c", "Write the setting as a short C program against libjointplay", 3,
     OPTION_TEXT, AT(code)},
    {"sdf", "FILE.sdf", "Write the contact in Gazebo's form", 3, OPTION_TEXT, AT(sdf)},
    {"mjcf", "FILE.xml", "Write the contact in MuJoCo's form", 3, OPTION_TEXT, AT(mjcf)},
    COMMON_JSON(3),
    COMMON_WIDE(3),
    COMMON_OUT(3, "Write <case>-tune.json, .txt, .c, .sdf and .xml there"),
    COMMON_QUIET(3),
};

// The cost that is minimized must be the one that is limited.
static bool settle_cost(TuneOptions *options, Err *err)
{
    const char *cost = options->asked_cost;
    const bool has_steps = options->limit.steps > 0;
    options->cost = has_steps ? TUNE_STEPS : TUNE_TIME;
    if (options->at_step_s > 0.0 && (has_steps || options->limit.time_s > 0.0)) {
        return err_set(err, ERR_USAGE,
                       "--max-cost and --at-step do not go together: with a fixed step there "
                       "is no cost to choose");
    }
    if (cost == NULL) {
        return true;
    }
    const TuneCost asked = strcmp(cost, "steps") == 0 ? TUNE_STEPS : TUNE_TIME;
    const bool has_limit = options->limit.steps > 0 || options->limit.time_s > 0.0;
    if (options->at_step_s > 0.0) {
        return err_set(err, ERR_USAGE,
                       "--cost and --at-step do not go together: with a fixed step there "
                       "is no cost to choose");
    }
    if (has_limit && asked != options->cost) {
        return err_set(err, ERR_USAGE, "--cost %s and a --max-cost in %s do not go together", cost,
                       options->cost == TUNE_STEPS ? "steps" : "time");
    }
    options->cost = asked;
    return true;
}

static bool check(void *target, Err *err)
{
    TuneOptions *options = target;
    if (options->common.path == NULL) {
        return err_set(err, ERR_USAGE, "no case given: jointplay tune CASE.yaml --error 1e-3");
    }
    if (options->error == 0.0 && options->at_step_s == 0.0) {
        char *path = shell_copy_path(options->common.path);
        err_set(err, ERR_USAGE, "no error given: jointplay tune %s --error 1e-3", path);
        free(path);
        return false;
    }
    return settle_cost(options, err);
}

const Arguments TUNE_ARGUMENTS = {
    .program = "jointplay tune",
    .usage = "CASE",
    .doc = "Searches for the cheapest setting of ODE whose error, found by running it against "
           "the certified reference, meets --error, and prints it as numbers, as ODE C code, "
           "and, as far as they can express it, for Gazebo and MuJoCo, with all that was tried."
           "\vExit status 1 says that no setting meets the error, or none within --max-cost.",
    .argument = COMMON_PATH("tune takes one case"),
    OPTION_ROWS(OPTIONS),
    .check = check,
};

TuneOptions tune_options_default(void)
{
    return (TuneOptions){.common.jobs = common_options_count_jobs(),
                         .common.time_limit_s = DEFAULT_TIME_LIMIT};
}

// What a program against libjointplay lacks for a scheme of ODE, or NULL.
static const char *program_lacks(const Scenario *scenario, const Scheme *scheme)
{
    Scenario setting = *scenario;
    scheme_apply(scheme, scenario->run.step, &setting);
    if (!scheme_has_step(scheme)) {
        // the way of stepping that a step chosen for a tolerance is for
        setting = scenario_with_step(&setting, setting.run.step);
    }
    return tune_world_lacks(&setting);
}

// Keeps the schemes that a program of --code can have, and says what it leaves out. Fails where
// none is left: nothing is searched for that cannot be written.
static bool keep_writable(const TuneOptions *options, const Scenario *scenario, Scheme *schemes,
                          size_t *count, Err *err)
{
    if (options->code == NULL) {
        return true;
    }
    if (scenario->linkage.is_spatial) {
        return err_set(err, ERR_USAGE, "--code: programs are written for cases in the plane alone");
    }
    const char *lacks = NULL;
    size_t kept = 0;
    size_t left_out = 0;
    Scheme first;
    for (size_t i = 0; i < *count; i++) {
        const char *why =
            schemes[i].backend == BACKEND_ODE ? program_lacks(scenario, &schemes[i]) : "";
        if (why == NULL) {
            schemes[kept++] = schemes[i];
        } else if (*why != '\0' && left_out++ == 0) {
            lacks = why;
            first = schemes[i];
        }
    }
    *count = kept;
    if (kept == 0) {
        return err_set(err, ERR_USAGE, "--code: %s", lacks);
    }
    if (left_out > 0 && !options->common.is_quiet) {
        output_say("left out for --code: %s%s (%s)\n", first.name,
                   left_out > 1 ? " and others" : "", lacks);
    }
    return true;
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
                       "the elastic law its error is that of the model, which no step removes; "
                       "allowed: contact.model impact");
    }
    const CommonOptions *common = &options->common;
    const bool is_held = options->at_step_s > 0.0;
    Scheme schemes[SCHEME_MAX];
    size_t scheme_count;
    if (!common_options_list_schemes(common, scenario, schemes, &scheme_count, err) ||
        !keep_writable(options, scenario, schemes, &scheme_count, err) ||
        (is_held && !common_options_check_step(common, options->at_step_s, err))) {
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

// Runs, settles and maps cases: by the functions behind the commands.
#include "library/library.h"

#include "base/zeroed.h"
#include "casefile/quantity.h"
#include "commands/map/map_settings.h"
#include "commands/run/run_overview.h"
#include "engine/driver.h"
#include "run/settle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char NO_CASE_TO_RUN[] = "there is no case: NULL was given for it";
static const char RUN_IN_USE[] = "the case is in use by a call that has not returned";

JpRunOptions jp_run_options_default(void)
{
    return (JpRunOptions){.size = sizeof(JpRunOptions), .is_whole = true};
}

JpMapOptions jp_map_options_default(void)
{
    return (JpMapOptions){.size = sizeof(JpMapOptions)};
}

// What a call works at.
typedef struct Running {
    JpCase *of;
    JpRunOptions options;
    JpMapOptions map;
    LibraryWatch watch;
    JpAnswer *made;
} Running;

static JpAnswer *answer_new(AnswerKind kind)
{
    JpAnswer *made = zeroed(1, sizeof *made);
    made->kind = kind;
    return made;
}

// The options of a caller that may be older than the library.
static bool take_options(const JpRunOptions *options, JpRunOptions *taken, JpCaseError *error)
{
    *taken = jp_run_options_default();
    if (options == NULL) {
        return true;
    }
    if (options->size == 0 || options->size > sizeof *taken) {
        library_refuse(error, "the options are not from jp_run_options_default of this library");
        return false;
    }
    memcpy(taken, options, options->size);
    if (taken->driver_count > 0 && taken->drivers == NULL) {
        library_refuse(error, "driver_count says that there are drivers, and drivers is NULL");
        return false;
    }
    if (!(taken->time_limit_s >= 0.0)) {
        library_refuse(error, "time_limit_s is a time in s, or 0 for the usual limit");
        return false;
    }
    return true;
}

static bool take_map_options(const JpMapOptions *options, JpMapOptions *taken, JpCaseError *error)
{
    *taken = jp_map_options_default();
    if (options == NULL) {
        return true;
    }
    if (options->size == 0 || options->size > sizeof *taken) {
        library_refuse(error, "the options are not from jp_map_options_default of this library");
        return false;
    }
    memcpy(taken, options, options->size);
    return true;
}

static ChosenWatch begin_part(const char *doing, void *context)
{
    Running *running = context;
    return (ChosenWatch){.run = library_watch(&running->watch, doing)};
}

static void end_part(void *context)
{
    (void)context;
}

// Drivers.

// The backend that a driver of NAME=PROGRAM is of.
static bool take_driver(Scenario *scenario, const char *driver, Err *err)
{
    char name[ENGINE_NAME_SIZE];
    if (driver == NULL || !engine_given_name(driver, name, err)) {
        return err_set(err, ERR_USAGE, "a driver is NULL; allowed: NAME=PROGRAM");
    }
    BackendKind backend = BACKEND_DRIVER;
    for (int i = 0; i < BACKEND_COUNT; i++) {
        backend = strcmp(OPTIONS_BACKENDS[i], name) == 0 ? (BackendKind)i : backend;
    }
    if (scenario->engines[backend].driver != NULL) {
        return err_set(err, ERR_USAGE, "two drivers are given for the backend '%s'",
                       OPTIONS_BACKENDS[backend]);
    }
    scenario->engines[backend].driver = driver;
    return true;
}

static bool take_drivers(const JpRunOptions *options, Scenario *scenario, Err *err)
{
    for (int i = 0; i < BACKEND_COUNT; i++) {
        scenario->engines[i].time_limit_s = options->time_limit_s;
    }
    for (size_t i = 0; i < options->driver_count; i++) {
        if (!take_driver(scenario, options->drivers[i], err)) {
            return false;
        }
    }
    return true;
}

// Runs.

static bool load_run(Running *running, CaseRun *run, Err *err)
{
    const JpRunOptions *options = &running->options;
    JpCase *of = running->of;
    Text backends;
    text_init(&backends);
    text_append(&backends, "run.backends=[%s]", options->backends != NULL ? options->backends : "");
    const char *further[] = {backends.data};
    const bool is_read =
        case_scenario(of, further, options->backends != NULL ? 1 : 0, &run->scenario, err);
    text_finish(&backends);
    if (!is_read) {
        return false;
    }
    run->is_uncertified = options->is_uncertified;
    run->is_quick = options->is_quick;
    run->is_whole = options->is_whole;
    run->path = of->name;
    run->as_read = (SpreadCase){.text = of->text,
                                .size = of->size,
                                .overrides = (const char *const *)of->set,
                                .override_count = of->set_count};
    run->scenario.run.keeps_contacts = options->has_contacts;
    run->scenario.run.keeps_ranges = options->has_ranges;
    run->scenario.run.keeps_marks = options->has_ranges;
    return take_drivers(options, &run->scenario, err) && case_run_check(run, err);
}

// Whether any run is complete; why the first is not.
static bool check_complete(const CaseRun *run, Err *err)
{
    const Trajectory *failed = NULL;
    for (size_t i = 0; i < run->report.run_count; i++) {
        if (run->runs[i]->is_complete) {
            return true;
        }
        failed = failed == NULL ? run->runs[i] : failed;
    }
    return err_set(err, ERR_SOLVER, "%zu of %zu runs failed: %s on %s: %s", run->failed_count,
                   run->report.run_count, scenario_path(&run->scenario),
                   failed != NULL ? failed->backend : "none",
                   failed != NULL ? failed->message : "");
}

static bool work_run(void *context, Err *err)
{
    Running *running = context;
    JpAnswer *made = answer_new(ANSWER_RUN);
    CaseRun *run = zeroed(1, sizeof *run);
    made->run = run;
    const CaseWatch watch = {begin_part, end_part, NULL, running};
    bool is_done = load_run(running, run, err);
    if (is_done) {
        case_run_execute(run, &watch);
        is_done = !call_is_cancelled() && check_complete(run, err);
        // what the caller and the case own is theirs again
        run->path = NULL;
        run->as_read = (SpreadCase){.text = NULL};
        for (int i = 0; i < BACKEND_COUNT; i++) {
            run->scenario.engines[i].driver = NULL;
        }
    }
    if (!is_done) {
        answer_destroy(made);
        return call_is_cancelled();
    }
    made->scenario = &run->scenario;
    made->tables = zeroed(run->report.run_count, sizeof *made->tables);
    running->made = made;
    return true;
}

// The settled motion.
static bool work_settle(void *context, Err *err)
{
    Running *running = context;
    JpAnswer *made = answer_new(ANSWER_SETTLED);
    made->scenario = zeroed(1, sizeof *made->scenario);
    if (!case_scenario(running->of, NULL, 0, made->scenario, err)) {
        answer_destroy(made);
        return false;
    }
    settle_scenario(made->scenario, library_watch(&running->watch, SETTLE_DOING));
    running->made = made;
    return true;
}

// Maps.

static bool read_map(const JpMapOptions *options, MapChoices *choices, Err *err)
{
    *choices = (MapChoices){
        .steps = options->steps,
        .maps = options->maps,
        .laws = options->laws,
        .mass = options->mass,
        .speed = options->speed,
    };
    if (options->at_step == NULL) {
        return true;
    }
    Complaint complaint;
    if (options->steps != NULL) {
        return err_set(err, ERR_USAGE, "at_step is the only step; it does not go with steps");
    }
    return (quantity_parse(options->at_step, DIMENSION_TIME, &choices->at_step_s, &complaint) &&
            choices->at_step_s > 0.0) ||
           err_set(err, ERR_USAGE, "at_step: '%s' is no time above 0; allowed: such as 1 ms",
                   options->at_step);
}

// What the command map says of its options, of those here: without their hyphens.
static bool name_options(Err *err)
{
    char *to = err->text;
    for (const char *from = err->text; *from != '\0';) {
        const bool begins = from == err->text || from[-1] == ' ' || from[-1] == '(';
        from += begins && strncmp(from, "--", 2) == 0 ? 2 : 0;
        *to++ = *from++;
    }
    *to = '\0';
    return false;
}

static void show_row(size_t done, size_t total, void *context)
{
    Running *running = context;
    running->watch.doing = "settings run in ODE";
    library_watch_show(&running->watch, (double)done / (double)(total > 0 ? total : 1));
}

static bool work_map(void *context, Err *err)
{
    Running *running = context;
    JpAnswer *made = answer_new(ANSWER_MAP);
    made->scenario = zeroed(1, sizeof *made->scenario);
    made->mapping = zeroed(1, sizeof *made->mapping);
    MappingSettings *settings = zeroed(1, sizeof *settings);
    MapChoices choices;
    bool is_done = read_map(&running->map, &choices, err) &&
                   case_scenario(running->of, NULL, 0, made->scenario, err);
    if (is_done) {
        settle_scenario(made->scenario, library_watch(&running->watch, SETTLE_DOING));
        const MappingWatch watch = {NULL, show_row,
                                    library_watch(&running->watch, "the reference's run"), running};
        is_done = (map_settings_read(&choices, made->scenario, settings, err) &&
                   mapping_make(made->scenario, settings, watch, made->mapping, err)) ||
                  name_options(err);
    }
    free(settings);
    if (!is_done) {
        answer_destroy(made);
        return call_is_cancelled();
    }
    running->made = made;
    return true;
}

// Calls.

// ODE's iterative solver draws from one sequence of random numbers in the process.
static bool is_alone(const JpCase *of)
{
    return of->scenario->ode.solver == ODE_QUICK;
}

static JpAnswer *ask(Running *running, LibraryWork *work, JpCaseError *error)
{
    JpCase *of = running->of;
    if (of == NULL || !case_take(of)) {
        library_refuse(error, of == NULL ? NO_CASE_TO_RUN : RUN_IN_USE);
        return NULL;
    }
    LibraryCall call = {
        .work = work,
        .context = running,
        .name = of->name,
        .threads = running->options.threads,
        .progress = running->options.progress,
        .watcher = running->options.context,
        .is_alone = is_alone(of),
    };
    running->watch.call = &call;
    const JpCaseStatus status = library_call(&call, error);
    if (status == JP_CASE_ERROR_CANCELLED) {
        answer_destroy(running->made);
    }
    case_give_back(of, status);
    return status == JP_CASE_OK ? running->made : NULL;
}

JpAnswer *jp_case_run(JpCase *of, const JpRunOptions *options, JpCaseError *error)
{
    Running running = {.of = of};
    return take_options(options, &running.options, error) ? ask(&running, work_run, error) : NULL;
}

JpAnswer *jp_case_settle(JpCase *of, const JpRunOptions *options, JpCaseError *error)
{
    Running running = {.of = of};
    return take_options(options, &running.options, error) ? ask(&running, work_settle, error)
                                                          : NULL;
}

JpAnswer *jp_case_map(JpCase *of, const JpMapOptions *options, JpCaseError *error)
{
    Running running = {.of = of};
    if (!take_map_options(options, &running.map, error)) {
        return NULL;
    }
    running.options = (JpRunOptions){.threads = running.map.threads,
                                     .progress = running.map.progress,
                                     .context = running.map.context};
    return ask(&running, work_map, error);
}

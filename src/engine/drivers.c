// Finds drivers of other engines, asks them what they are, and runs cases by them.
#include "engine/driver.h"

#include "base/prefix.h"
#include "base/text.h"
#include "engine/converse.h"
#include "engine/features.h"
#include "engine/protocol.h"
#include "model/options.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// for a driver to say what it is: a Python script with its libraries takes some seconds
static const double HELLO_LIMIT_S = 20.0;

// 1: of a run, at most, up to which a driver is asked whether it takes the case
static const double FIRST_SHARE = 1e-4;

enum {
    HELLO_OUTPUT_MOST = 1 << 20,
    OUTPUT_MOST = 1 << 30, // of a run: samples of 50,000 a second for minutes
    FOLDER_COUNT = 3,
};

bool engine_is_name(const char *word)
{
    static const char LETTERS[] = "abcdefghijklmnopqrstuvwxyz";
    static const char ALL[] = "abcdefghijklmnopqrstuvwxyz0123456789-";
    const size_t length = strlen(word);
    return length > 0 && length < ENGINE_NAME_SIZE && strchr(LETTERS, word[0]) != NULL &&
           strspn(word, ALL) == length;
}

// Where drivers that came with the program may be: a folder that the user names instead, that of an
// installation, and that of a build. Returns how many there are.
static size_t list_folders(char folders[FOLDER_COUNT][ENGINE_PATH_SIZE])
{
    const char *named = getenv("JOINTPLAY_DRIVERS");
    if (named != NULL) {
        text_copy(folders[0], ENGINE_PATH_SIZE, named);
        return 1;
    }
    char prefix[ENGINE_PATH_SIZE / 2];
    if (!prefix_find(prefix, sizeof prefix)) {
        return 0;
    }
    snprintf(folders[0], ENGINE_PATH_SIZE, "%s/libexec/jointplay", prefix);
    snprintf(folders[1], ENGINE_PATH_SIZE, "%s/drivers", prefix);
    return 2;
}

// Whether a name is that of one of our own solvers.
static bool is_own(const char *name)
{
    bool is_any = false;
    for (int i = 0; i < BACKEND_COUNT; i++) {
        is_any = is_any ||
                 (!options_is_engine((BackendKind)i) && strcmp(OPTIONS_BACKENDS[i], name) == 0);
    }
    return is_any;
}

// Whether a file of that name in a folder can be run; writes its path.
static bool find_in(const char *folder, const char *name, char path[ENGINE_PATH_SIZE])
{
    const int length = snprintf(path, ENGINE_PATH_SIZE, "%s/jointplay-%s", folder, name);
    return length < ENGINE_PATH_SIZE && access(path, X_OK) == 0;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(a, b);
}

void engine_list(char *text, size_t size)
{
    char folders[FOLDER_COUNT][ENGINE_PATH_SIZE];
    char names[ENGINE_DRIVER_MAX][ENGINE_NAME_SIZE];
    char path[ENGINE_PATH_SIZE];
    static const char PREFIX[] = "jointplay-";
    const size_t prefix = sizeof PREFIX - 1;
    size_t count = 0;
    const size_t folder_count = list_folders(folders);
    for (size_t i = 0; i < folder_count && count == 0; i++) {
        DIR *folder = opendir(folders[i]);
        for (struct dirent *entry; folder != NULL && (entry = readdir(folder)) != NULL;) {
            const char *name = entry->d_name + prefix;
            if (strncmp(entry->d_name, PREFIX, prefix) == 0 && engine_is_name(name) &&
                count < ENGINE_DRIVER_MAX && find_in(folders[i], name, path)) {
                text_copy(names[count++], ENGINE_NAME_SIZE, name);
            }
        }
        if (folder != NULL) {
            closedir(folder);
        }
    }
    qsort(names, count, sizeof names[0], by_name);
    size_t length = 0;
    text[0] = '\0';
    for (size_t i = 0; i < count && length < size; i++) {
        length +=
            (size_t)snprintf(text + length, size - length, "%s%s", i > 0 ? ", " : "", names[i]);
    }
}

// Asks a driver, whose name and program are known, what it is.
static bool ask_hello(EngineDriver *driver, Err *err)
{
    EngineReply reply = engine_reply_start(NULL, driver, NULL, NULL);
    Err own = {0};
    const Converse with = {
        .program = driver->program,
        .input = ENGINE_HELLO,
        .input_size = strlen(ENGINE_HELLO),
        .time_limit_s = HELLO_LIMIT_S,
        .output_most = HELLO_OUTPUT_MOST,
        .take = engine_reply_take,
        .context = &reply,
    };
    const bool is_known = converse(&with, &own) && engine_reply_check(&reply, &own);
    engine_reply_finish(&reply);
    return is_known || err_set(err, ERR_SOLVER, "the driver '%s' (%s): %s", driver->name,
                               driver->program, own.text);
}

// Whether a build makes the driver of that name where its engine is installed.
static bool is_ours(const char *name)
{
    bool is_one = false;
    for (int i = 0; OPTIONS_BACKENDS[i] != NULL; i++) {
        const bool is_built = options_is_engine((BackendKind)i) && i != BACKEND_DRIVER;
        is_one = is_one || (is_built && strcmp(OPTIONS_BACKENDS[i], name) == 0);
    }
    return is_one;
}

bool engine_find(const char *name, EngineDriver *driver, Err *err)
{
    char folders[FOLDER_COUNT][ENGINE_PATH_SIZE];
    *driver = (EngineDriver){.way_count = 0};
    const size_t count = list_folders(folders);
    for (size_t i = 0; engine_is_name(name) && i < count; i++) {
        if (find_in(folders[i], name, driver->program)) {
            text_copy(driver->name, sizeof driver->name, name);
            return ask_hello(driver, err);
        }
    }
    char known[ENGINE_DRIVER_MAX * ENGINE_NAME_SIZE];
    engine_list(known, sizeof known);
    return err_set(err, ERR_USAGE,
                   "there is no driver for '%s' here: %s%s; %s--driver %s=PROGRAM names one", name,
                   known[0] != '\0' ? "there are ode, " : "there is ode alone", known,
                   is_ours(name) ? "build jointplay where the engine is installed "
                                   "('./bootstrap packages engines' does that), or "
                                 : "",
                   engine_is_name(name) ? name : "NAME");
}

bool engine_given_name(const char *name_and_program, char name[ENGINE_NAME_SIZE], Err *err)
{
    const char *mark = strchr(name_and_program, '=');
    name[0] = '\0';
    if (mark != NULL && mark - name_and_program < ENGINE_NAME_SIZE) {
        snprintf(name, ENGINE_NAME_SIZE, "%.*s", (int)(mark - name_and_program), name_and_program);
    }
    return (engine_is_name(name) && !is_own(name) && mark[1] != '\0') ||
           err_set(err, ERR_USAGE,
                   "--driver takes NAME=PROGRAM, with a name of lower-case letters, digits "
                   "and '-' that is none of our own backends, not '%s'",
                   name_and_program);
}

bool engine_given(const char *name_and_program, EngineDriver *driver, Err *err)
{
    char name[ENGINE_NAME_SIZE];
    *driver = (EngineDriver){.way_count = 0};
    if (!engine_given_name(name_and_program, name, err)) {
        return false;
    }
    const char *mark = strchr(name_and_program, '=');
    // a program without a folder is one in this folder: nothing is looked for in PATH
    const int length = snprintf(driver->program, sizeof driver->program, "%s%s",
                                strchr(mark + 1, '/') == NULL ? "./" : "", mark + 1);
    if (length >= (int)sizeof driver->program) {
        return err_set(err, ERR_USAGE, "the path of the driver '%s' is too long", name);
    }
    text_copy(driver->name, sizeof driver->name, name);
    return ask_hello(driver, err);
}

// What a driver says that it takes in a way.
static unsigned takes_in(const EngineDriver *driver, const char *way)
{
    unsigned takes = 0;
    for (size_t i = 0; i < driver->way_count; i++) {
        takes = strcmp(driver->ways[i], way) == 0 ? driver->takes[i] : takes;
    }
    return takes;
}

// Whether a driver can be told of all of a scenario.
static bool check_protocol(const EngineDriver *driver, const Scenario *scenario, Err *err)
{
    char needed[ENGINE_NEED_SIZE];
    if (!engine_check(driver->name, scenario, err)) {
        return false;
    }
    const int protocol = engine_needs(scenario, needed);
    if (protocol <= driver->protocol) {
        return true;
    }
    char what[2 * ENGINE_NEED_SIZE];
    snprintf(what, sizeof what, "%s, which protocol %d for drivers has and its %d has not", needed,
             protocol, driver->protocol);
    return engine_refuse(driver->name, what, err);
}

// Whether a driver can be told of it and takes it in a way; what it does not take is said.
static bool check_told(const EngineDriver *driver, const char *way, const Scenario *scenario,
                       EngineSaid *said, Err *err)
{
    char needed[ENGINE_NEED_SIZE];
    if (!check_protocol(driver, scenario, err)) {
        said->is_refused = true;
        return false;
    }
    if (!engine_features_lack(scenario, takes_in(driver, way), needed)) {
        return true;
    }
    said->is_refused = true;
    text_copy(said->refused, sizeof said->refused, needed);
    return engine_refuse(driver->name, needed, err);
}

// Runs the scenario and fills the trajectory.
static bool fill(const EngineDriver *driver, const char *way, const Scenario *scenario,
                 double time_limit_s, Trajectory *trajectory, EngineSaid *said,
                 EngineRecords *records, Err *err)
{
    EngineDriver again = *driver; // what it says of itself in this run
    if (!check_told(driver, way, scenario, said, err)) {
        return false;
    }
    char *request = engine_request(scenario, way, records != NULL ? records->record_s : 0.0,
                                   said->model != NULL, err);
    if (request == NULL) {
        return false;
    }
    EngineReply reply = engine_reply_start(scenario, &again, trajectory, said);
    reply.records = records;
    const Converse with = {
        .program = driver->program,
        .input = request,
        .input_size = strlen(request),
        .time_limit_s = time_limit_s,
        .output_most = OUTPUT_MOST,
        .take = engine_reply_take,
        .context = &reply,
    };
    const bool is_done = converse(&with, err) && engine_reply_check(&reply, err);
    engine_reply_finish(&reply);
    free(request);
    return is_done;
}

static Trajectory *run_said(const EngineDriver *driver, const char *way, const Scenario *scenario,
                            double time_limit_s, EngineSaid *said, EngineRecords *records)
{
    Err err = {0};
    Trajectory *trajectory = trajectory_create(scenario, driver->name);
    if (trajectory->message[0] != '\0') {
        return trajectory; // there is no room for the samples
    }
    snprintf(trajectory->label, sizeof trajectory->label, "%s %s", driver->name, way);
    trajectory->step_s = scenario->run.step;
    trajectory->duration_s = scenario_duration(scenario);
    trajectory->is_complete =
        fill(driver, way, scenario, time_limit_s, trajectory, said, records, &err);
    if (!trajectory->is_complete) {
        err_prefix(&err, trajectory->label);
        text_copy(trajectory->message, sizeof trajectory->message, err.text);
    }
    return trajectory;
}

Trajectory *engine_run(const EngineDriver *driver, const char *way, const Scenario *scenario,
                       double time_limit_s, EngineSaid *said)
{
    return engine_run_recorded(driver, way, scenario, time_limit_s, said, NULL);
}

Trajectory *engine_run_model(const EngineDriver *driver, const char *way, const Scenario *scenario,
                             double time_limit_s, EngineSaid *said, char **model)
{
    *model = NULL;
    *said = (EngineSaid){.model = model};
    return run_said(driver, way, scenario, time_limit_s, said, NULL);
}

Trajectory *engine_run_recorded(const EngineDriver *driver, const char *way,
                                const Scenario *scenario, double time_limit_s, EngineSaid *said,
                                EngineRecords *records)
{
    EngineSaid own;
    said = said != NULL ? said : &own;
    *said = (EngineSaid){.opening_m = 0.0};
    return run_said(driver, way, scenario, time_limit_s, said, records);
}

// The scenario up to its first sample alone.
static Scenario first_sample(const Scenario *scenario)
{
    Scenario first = *scenario;
    const double duration_s = scenario_duration(scenario);
    // a step that is chosen as the run goes is none yet
    first.run.step = scenario->run.step > 0.0 ? scenario->run.step : FIRST_SHARE * duration_s;
    const double share = fmin(first.run.step / duration_s, FIRST_SHARE);
    first.run.revolutions *= share;
    first.run.duration *= share;
    return first;
}

bool engine_takes(const EngineDriver *driver, const char *const *ways, size_t count,
                  const Scenario *scenario, double time_limit_s, Err *err)
{
    if (!check_protocol(driver, scenario, err)) {
        return false;
    }
    const double limit_s = time_limit_s > 0.0 ? fmin(time_limit_s, HELLO_LIMIT_S) : HELLO_LIMIT_S;
    const Scenario first = first_sample(scenario);
    EngineSaid said = {.is_refused = false};
    for (size_t i = 0; i < count; i++) {
        trajectory_destroy(engine_run(driver, ways[i], &first, limit_s, &said));
        if (!said.is_refused) {
            return true;
        }
    }
    char name[2 * ENGINE_NAME_SIZE];
    snprintf(name, sizeof name, "%s%s%s", driver->name, count == 1 ? "/" : "",
             count == 1 ? ways[0] : "");
    return count == 0 || engine_refuse(name, said.refused, err);
}

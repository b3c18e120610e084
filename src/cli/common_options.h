// The options that several commands share: their rows, and what was given.
#pragma once

#include "cli/arguments.h"
#include "measure/scheme.h"

enum {
    OPTION_SETTING_MAX = 256, // values that --set may give on one command line
    // processes at a time that --jobs may ask for: more than there are processors are allowed, for
    // the number is often written for another machine
    OPTION_JOB_MAX = 256,
};

// The first member of the options of every command that has rows of those below.
typedef struct CommonOptions {
    const char *path; // of the case or study; NULL until it is given
    const char *overrides[OPTION_SETTING_MAX];
    size_t override_count;
    const char *schemes;                    // as given, or NULL
    const char *drivers[ENGINE_DRIVER_MAX]; // NAME=PROGRAM each
    size_t driver_count;
    size_t jobs;
    double time_limit_s; // of one run
    const char *folder;  // of --out, or NULL
    bool is_json;
    bool is_full; // all tables, and not the first screen alone
    bool is_wide; // tables need not fit the terminal
    bool is_quiet;
} CommonOptions;

// Rows of a list of options, in a group of its help.
// clang-format off
#define COMMON_AT(field) .offset = offsetof(CommonOptions, field)
#define COMMON_PATH(words) {.type = OPTION_TEXT, COMMON_AT(path), .what = (words)}
#define COMMON_SET(help_group) \
    {"set", "KEY=VALUE", "Replace a value of the case, such as contact.restitution=0.8; may be given often", \
     help_group, OPTION_LIST, COMMON_AT(overrides), .what = "settings", \
     .count_offset = offsetof(CommonOptions, override_count), .high = OPTION_SETTING_MAX}
#define COMMON_SCHEMES(help_group) \
    {"schemes", "LIST", "Only these schemes of ODE: 'direct/corrected' selects those with both words, 'all' every scheme", \
     help_group, OPTION_TEXT, COMMON_AT(schemes)}
#define COMMON_DRIVERS(help_group) \
    {"driver", "NAME=PROGRAM", "A program that runs cases on the engine NAME; may be given often", \
     help_group, OPTION_LIST, COMMON_AT(drivers), .what = "drivers", \
     .count_offset = offsetof(CommonOptions, driver_count), .high = ENGINE_DRIVER_MAX}
#define COMMON_JOBS(help_group, words) \
    {"jobs", "N", words, help_group, OPTION_COUNT, COMMON_AT(jobs), .low = 1, .high = OPTION_JOB_MAX}
#define COMMON_TIME_LIMIT(help_group, words) \
    {"time-limit", "TIME", words, help_group, OPTION_QUANTITY, COMMON_AT(time_limit_s), .dimension = DIMENSION_TIME}
#define COMMON_OUT(help_group, words) {"out", "DIR", words, help_group, OPTION_TEXT, COMMON_AT(folder)}
#define COMMON_JSON(help_group) \
    {"json", NULL, "Print one JSON object instead of tables", help_group, OPTION_FLAG, COMMON_AT(is_json)}
#define COMMON_FULL(help_group) \
    {"full", NULL, "All tables, and not the first screen alone", help_group, OPTION_FLAG, COMMON_AT(is_full)}
#define COMMON_WIDE(help_group) \
    {"wide", NULL, "All columns of the tables, however wide the terminal is", help_group, OPTION_FLAG, COMMON_AT(is_wide)}
#define COMMON_QUIET(help_group) \
    {"quiet", NULL, "Nothing on standard error but errors and warnings of long work and of files that are not written", help_group, OPTION_FLAG, \
     COMMON_AT(is_quiet), .letter = 'q'}
// clang-format on

// Processes at a time where --jobs is not given: one a processor, at most OPTION_JOB_MAX.
size_t common_options_count_jobs(void);

// Reads the case of the path with the values of --set. Fails as casefile_load does.
bool common_options_read(const CommonOptions *options, Scenario *scenario, Err *err);

// Finds the settled start of a case that is to have one, and shows how far it has come.
void common_options_settle(const CommonOptions *options, Scenario *scenario);

// Reads the case, and finds its start.
bool common_options_load(const CommonOptions *options, Scenario *scenario, Err *err);

// Whether the case can be run at a step, s: it is read once more with it, so that the checks and
// their words are those of the case file. Fails as casefile_load does.
bool common_options_check_step(const CommonOptions *options, double step_s, Err *err);

// The backend that a driver of NAME=PROGRAM is of: that of its name, or `driver`. Fails with
// ERR_USAGE where it has another form.
bool common_options_driver(const char *driver, BackendKind *backend, Err *err);

// Lets the engine of a driver, which must outlive the scenario, be run by it; writes which backend
// that is. Fails with ERR_USAGE where it has another form, or the backend has one.
bool common_options_take_driver(const char *driver, Scenario *scenario, BackendKind *backend,
                                Err *err);

// Lets a run of any engine take so long, s, by the clock on the wall; 0: the usual limit.
void common_options_limit_drivers(double time_limit_s, Scenario *scenario);

// Both, of all that --driver names, each of which must be of a backend of the run, and of
// --time-limit.
bool common_options_take_drivers(const CommonOptions *options, Scenario *scenario, Err *err);

// The schemes of a scenario that --schemes names, or the usual ones. Fails with ERR_USAGE for a
// word that none of them has.
bool common_options_list_schemes(const CommonOptions *options, const Scenario *scenario,
                                 Scheme schemes[SCHEME_MAX], size_t *count, Err *err);

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
    const char *schemes; // as given, or NULL
    size_t jobs;
    double time_limit_s; // of one run
    const char *folder;  // of --out, or NULL
    bool is_json;
    bool is_wide; // tables need not fit the terminal
    bool is_quiet;
} CommonOptions;

// Rows of a list of options, in a group of its help.
#define COMMON_PATH(allowed)                                                                       \
    {                                                                                              \
        .type = OPTION_TEXT, .offset = offsetof(CommonOptions, path), .what = allowed              \
    }
#define COMMON_SET(help_group)                                                                     \
    {                                                                                              \
        .name = "set", .value = "KEY=VALUE", .group = help_group, .type = OPTION_LIST,             \
        .doc = "Replace a value of the case, such as contact.restitution=0.8; may be given often", \
        .offset = offsetof(CommonOptions, overrides),                                              \
        .count_offset = offsetof(CommonOptions, override_count), .high = OPTION_SETTING_MAX,       \
        .what = "settings"                                                                         \
    }
#define COMMON_SCHEMES(help_group)                                                                 \
    {                                                                                              \
        .name = "schemes", .value = "LIST", .group = help_group, .type = OPTION_TEXT,              \
        .doc = "Only these schemes of ODE: 'direct/corrected' is every one with both words, "      \
               "'all' every one",                                                                  \
        .offset = offsetof(CommonOptions, schemes)                                                 \
    }
#define COMMON_JOBS(help_group, words)                                                             \
    {                                                                                              \
        .name = "jobs", .value = "N", .group = help_group, .type = OPTION_COUNT, .doc = words,     \
        .offset = offsetof(CommonOptions, jobs), .low = 1, .high = OPTION_JOB_MAX                  \
    }
#define COMMON_TIME_LIMIT(help_group, words)                                                       \
    {                                                                                              \
        .name = "time-limit", .value = "TIME", .group = help_group, .type = OPTION_QUANTITY,       \
        .doc = words, .offset = offsetof(CommonOptions, time_limit_s), .dimension = DIMENSION_TIME \
    }
#define COMMON_OUT(help_group, words)                                                              \
    {                                                                                              \
        .name = "out", .value = "DIR", .group = help_group, .type = OPTION_TEXT, .doc = words,     \
        .offset = offsetof(CommonOptions, folder)                                                  \
    }
#define COMMON_JSON(help_group)                                                                    \
    {                                                                                              \
        .name = "json", .group = help_group, .doc = "Print one JSON object instead of tables",     \
        .type = OPTION_FLAG, .offset = offsetof(CommonOptions, is_json)                            \
    }
#define COMMON_WIDE(help_group)                                                                    \
    {                                                                                              \
        .name = "wide", .group = help_group,                                                       \
        .doc = "All columns of the tables, however wide the terminal is", .type = OPTION_FLAG,     \
        .offset = offsetof(CommonOptions, is_wide)                                                 \
    }
#define COMMON_QUIET(help_group)                                                                   \
    {                                                                                              \
        .name = "quiet", .letter = 'q', .group = help_group,                                       \
        .doc = "Nothing on standard error but errors and a warning of long work",                  \
        .type = OPTION_FLAG, .offset = offsetof(CommonOptions, is_quiet)                           \
    }

// Processes at a time where --jobs is not given: one a processor, at most OPTION_JOB_MAX.
size_t common_options_count_jobs(void);

// Reads the case of the path with the values of --set. Fails as casefile_load does.
bool common_options_load(const CommonOptions *options, Scenario *scenario, Err *err);

// Whether the case can be run at a step, s: it is read once more with it, so that the checks and
// their words are those of the case file. Fails as casefile_load does.
bool common_options_check_step(const CommonOptions *options, double step_s, Err *err);

// The schemes of a scenario that --schemes names, or the usual ones. Fails with ERR_USAGE for a
// word that none of them has.
bool common_options_list_schemes(const CommonOptions *options, const Scenario *scenario,
                                 Scheme schemes[SCHEME_MAX], size_t *count, Err *err);

// The options that several commands share: their rows, their keys, and what was given. Whatever a
// command says of them in words of its own, it lists in a row of its own with the key from here.
#pragma once

#include "base/err.h"
#include "cli/arguments.h"
#include "cli/option_values.h"
#include "measure/scheme.h"

#include <stdbool.h>
#include <stddef.h>

// Beyond the keys of any command, which begin at 0x100 to 0x300.
enum {
    COMMON_SET = 0x400,
    COMMON_SCHEMES,
    COMMON_JOBS,
    COMMON_TIME_LIMIT,
    COMMON_JSON,
    COMMON_OUT,
    COMMON_WIDE,
    COMMON_QUIET = 'q',
};

// Rows of a list of options, in a group of its help; macros, for the lists are constant.
#define COMMON_ROW_SET(group)                                                                      \
    {                                                                                              \
        "set", COMMON_SET, "KEY=VALUE", 0,                                                         \
            "Replace a value of the case, such as contact.restitution=0.8; may be given often",    \
            group                                                                                  \
    }
#define COMMON_ROW_SCHEMES(group)                                                                  \
    {                                                                                              \
        "schemes", COMMON_SCHEMES, "LIST", 0,                                                      \
            "Only these schemes of ODE: 'direct/corrected' is every one with both words, 'all' "   \
            "every one",                                                                           \
            group                                                                                  \
    }
#define COMMON_ROW_JSON(group)                                                                     \
    {                                                                                              \
        "json", COMMON_JSON, NULL, 0, "Print one JSON object instead of tables", group             \
    }
#define COMMON_ROW_WIDE(group)                                                                     \
    {                                                                                              \
        "wide", COMMON_WIDE, NULL, 0, "All columns of the tables, however wide the terminal is",   \
            group                                                                                  \
    }
#define COMMON_ROW_QUIET(group)                                                                    \
    {                                                                                              \
        "quiet", COMMON_QUIET, NULL, 0,                                                            \
            "Nothing on standard error but errors and a warning of long work", group               \
    }

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

// Takes an option by one of the keys above. Fails with ERR_USAGE.
bool common_options_take(int key, const char *value, CommonOptions *options, Err *err);

// Takes the one path that a command has; `allowed` says so where there are two: "map takes one
// case". Fails with ERR_USAGE.
bool common_options_take_path(const char *path, CommonOptions *options, const char *allowed,
                              Err *err);

// The schemes of a scenario that --schemes names, or the usual ones. Fails with ERR_USAGE for a
// word that none of them has.
bool common_options_list_schemes(const CommonOptions *options, const Scenario *scenario,
                                 Scheme schemes[SCHEME_MAX], size_t *count, Err *err);

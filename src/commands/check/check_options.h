// What `jointplay check` was asked for.
#pragma once

#include "base/err.h"
#include "cli/common_options.h"

#include <stdbool.h>

enum { CHECK_PATH_MAX = 4096 }; // cases on one command line

typedef struct CheckOptions {
    CommonOptions common;              // its time limit that of one start; no path or folder
    const char *paths[CHECK_PATH_MAX]; // of the cases; none: all that have a baseline
    size_t path_count;
    const char *folder; // of the baselines
    bool is_blessing;
    bool is_quick;
    bool is_expect_only;
    bool is_all;
    size_t shake; // seed; 0: none
    const char *junit;
    const char *markdown;
} CheckOptions;

extern const Arguments CHECK_ARGUMENTS;
void check_options_init(CheckOptions *options);

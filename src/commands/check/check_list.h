// Which cases are checked, and against which files.
#pragma once

#include "base/err.h"
#include "cli/common_options.h"
#include "commands/check/baseline.h"
#include "commands/check/check_report.h"
#include "write/file.h"

#include <stdbool.h>

// What `jointplay check` was asked for.

enum { CHECK_PATH_MAX = 4096 }; // cases on one command line

typedef struct CheckOptions {
    CommonOptions common;              // its time limit that of one start; no path or folder
    const char *paths[CHECK_PATH_MAX]; // of the cases; none: all that have a baseline
    size_t path_count;
    const char *folder;           // of the baselines; NULL: the usual one
    char shipped[FILE_PATH_SIZE]; // folder of those that came with the program, with is_shipped
    bool is_shipped;              // the program's own cases against its own baselines
    bool is_blessing;
    bool is_quick;
    double relative; // 1, of each number: how far it may move at least; 0: as its band says
    bool is_expect_only;
    bool is_all;
    size_t shake; // seed; 0: none
    const char *junit;
    const char *markdown;
} CheckOptions;

extern const Arguments CHECK_ARGUMENTS;
void check_options_init(CheckOptions *options);

// One case of a check. What could not be had stands in the error; the rest goes on.
typedef struct CheckItem {
    char path[FILE_PATH_SIZE];          // of the case, as people would write it here
    char baseline_path[FILE_PATH_SIZE]; //
    char relative[FILE_PATH_SIZE];      // of the case, seen from the baseline's folder
    bool is_shipped;                    // the case came with the program
    Scenario *scenario;                 // owned; NULL where the case could not be read
    Baseline baseline;                  // empty where it could not be read
    Baseline now;                       // head of what this program makes of the case
    char no_truth[CHECK_NOTE_SIZE];     // why an error that is limited is not measured
    Err err;                            // of the case or its baseline
    bool has_baseline;                  // false: the limits of the case alone judge it
    bool is_there;                      // a file stands where the baseline belongs
    Err baseline_err;                   // when blessing: why there is no old one to read
    bool is_refused;                    // the file was refused, as it expects:
    ExpectedOutcome refusal;            // so
    Err refused;                        // with this
    char title[SCENARIO_TITLE_SIZE];    // of a file that was
} CheckItem;

// Lists the cases, those of a folder by name, and reads them and their baselines. A case or a
// baseline that cannot be read is an error of its item. Fails with ERR_FILE where there is not one
// baseline to check, or where a new one would replace what is none; with ERR_USAGE for a setting
// that is wrong, or for two cases that would have one baseline; the list is then empty.
bool check_list_make(const CheckOptions *options, CheckItem **items, size_t *count, Err *err);
void check_list_destroy(CheckItem *items, size_t count);

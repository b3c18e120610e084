// The commands of `jointplay study`, the paths of its stores, and its reports.
#pragma once

#include "base/err.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/common_options.h"
#include "commands/study/design.h"
#include "commands/study/store.h"
#include "commands/study/sweep.h"
#include "write/file.h"
#include "write/table.h"

#include <jansson.h>

// `jointplay study FILE`, and the commands behind `jointplay study`, each listed by its first word.

typedef struct StudyOptions {
    CommonOptions common; // its path that of the study file
    Shard shard;
    char store[FILE_PATH_SIZE]; // as given, or the usual one
    bool is_fresh;
    bool is_retrying;
    bool is_dry;
} StudyOptions;

// Makes the runs and prints what came of it. Fails with ERR_FILE and ERR_CASE where a file is
// wrong, with ERR_SOLVER where every run failed.
bool study_run(void *options, Err *err);

// Prints what would be run, and how long that would take by the first runs, which are made for it
// and not kept.
bool study_run_dry(const StudyOptions *options, const Spec *spec, const Layout *layout, Err *err);

// What the first runs of a study took.
typedef struct StudyPace {
    uint64_t made;
    double wall_s;  // of all of them
    uint64_t least; // that say how long the others take
} StudyPace;

// Makes runs of a study for a few seconds, or until one is over, into a store that is then removed.
// No run is made where there is no room for such a store.
StudyPace study_run_pace(const StudyOptions *options, const Spec *spec, const Layout *layout);

extern const Command study_command_status;
extern const Command study_command_export;
extern const Command study_command_merge;
extern const Command study_command_plot;
extern const Command study_command_slurm;

// The options of a command that takes any number of words.
typedef struct StudyWords {
    size_t count;
    const char **words; // the words themselves are the command line's
    bool is_wide;
    bool is_quiet;
} StudyWords;

// Where the stores of a study are, by their usual names.

// The usual name of the store of a study file or of a part of it: <stem>.sqlite, and
// <stem>.2-of-3.sqlite for the second of three. Fails with ERR_FILE where the path is too long.
bool study_path_name(const char *study, Shard shard, char name[FILE_PATH_SIZE], Err *err);

// That store in its folder: the working folder, or that of the study file where it alone has stores
// of the study. Fails as above.
bool study_path_store(const char *study, Shard shard, char path[FILE_PATH_SIZE], Err *err);

// Whether the word names a study file, by its ending, and not a store.
bool study_path_is_study(const char *word);

// The store that a word of the command line means: the word, or the usual one of a study file,
// which must be there. Fails with ERR_FILE.
bool study_path_find(const char *word, char path[FILE_PATH_SIZE], Err *err);

// What `jointplay study status` prints for people.

// A store, and how much of its study it is to hold.
typedef struct StudyPart {
    const char *path;
    Store *store;    // being viewed; NULL: nothing is there yet
    uint64_t wanted; // runs it is to hold in the end
} StudyPart;

// How far the parts of one study have come: runs that are over, what became of them, the most
// frequent reasons with an example of each, the time they took and what is left. The places say
// where a store that is not there was looked for: "in the working folder". Fails with ERR_FILE.
bool study_text_status(const StudyPart *parts, size_t part_count, const char *places,
                       const Style *style, Text *text, Err *err);

// The distribution over the runs that went well, least, 5 %, median, 95 %, most, of the main
// results, or of all that any run has. Fails with ERR_FILE.
bool study_text_summary(Store *store, bool is_full, const Style *style, Text *text, Err *err);

// The rows of a study's store, for other programs: a row a run, by rising number of run.

// As a table whose first line names the columns: the run, its settings, what became of it, its
// results, the hash of its trajectory in 16 hexadecimal digits, its wall time. What is not known or
// not finite is an empty cell. The path may be "-" for standard output. Memory does not grow with
// the number of runs. Fails with ERR_FILE.
bool study_rows_write_csv(Store *store, const char *path, Err *err);

// The same as lines of JSON, an object a run. What is not known or not finite is null.
bool study_rows_write_jsonl(Store *store, const char *path, Err *err);

// What `jointplay study` did, and what it prints with --json.

// All of it belongs to others.
typedef struct StudyReport {
    const Spec *spec;
    const char *store; // path
    Shard shard;
    size_t jobs;
    SweepState state;      // at the end of the sweep
    StoreCount count;      // of the store
    double children_cpu_s; // processor time of the processes that made runs and truths
    double own_cpu_s;      // of the one that started them and kept what they made
    double inside_share;   // of the jobs' time that was spent inside the processes of runs and
                           // truths, 0 to 1; NAN where nothing was made
} StudyReport;

json_t *study_json_build(const StudyReport *report);

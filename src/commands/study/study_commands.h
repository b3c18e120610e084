// `jointplay study FILE`, and the commands behind `jointplay study`, each listed by its first word.
#pragma once

#include "cli/command.h"
#include "cli/common_options.h"
#include "commands/study/design.h"
#include "write/file.h"

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

// Prints what would be run, and runs nothing.
bool study_run_dry(const StudyOptions *options, const Spec *spec, const Layout *layout, Err *err);

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

// The argument of such a command.
bool study_words_read(const char *word, void *words, Err *err);

// Reads the command line and does the work with its words, unless help was all that was asked for.
// Fails as arguments_run does, or the work.
bool study_words_run(const Arguments *arguments, int argc, char **argv,
                     bool (*work)(void *words, Err *err), Err *err);

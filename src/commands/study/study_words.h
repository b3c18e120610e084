// The words of a command of `jointplay study` that takes any number of them.
#pragma once

#include "cli/arguments.h"

#include <stdbool.h>
#include <stddef.h>

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

// Reads the options and arguments of one command, with argp doing the work and Err the talking.
#pragma once

#include "base/err.h"

#include <argp.h>
#include <stdbool.h>

typedef struct Arguments {
    const char *program;               // as in a message: "jointplay run"
    const char *usage;                 // of what is no option: "CASE..."
    const char *doc;                   // what the command does; behind a \v, more of it
    const struct argp_option *options; // ends in {0}; --help is added
    // Takes one option by its key, or an argument by ARGP_KEY_ARG. May fail with ERR_USAGE.
    bool (*take)(int key, const char *value, void *target, Err *err);
} Arguments;

// Options and arguments may come in any order. Fails with ERR_USAGE; an option that does not exist
// is answered with the one that may have been meant. Where --help was asked for, it is printed and
// *is_answered is true: there is nothing left to do.
bool arguments_parse(const Arguments *arguments, int argc, char **argv, void *target,
                     bool *is_answered, Err *err);

// Reads the command line of one command by a table with one row per option. argp parses; errors are
// reported through Err.
#pragma once

#include "base/err.h"
#include "casefile/units.h"

#include <stdbool.h>
#include <stddef.h>

// How a value is written, and what it becomes in the command's options.
typedef enum OptionType {
    OPTION_NONE,     // there is none: of a command without arguments
    OPTION_FLAG,     // no value -> bool
    OPTION_TEXT,     // as it is written -> const char *
    OPTION_CHOICE,   // one of the words -> const char *
    OPTION_PICTURE,  // path of an SVG -> const char *
    OPTION_LIST,     // as it is written, may be given often -> const char *[high], and how many
    OPTION_COUNT,    // whole number from low to high -> size_t
    OPTION_QUANTITY, // number above 0 with a unit of the dimension -> double, SI
    OPTION_READ,     // by a function of its own
} OptionType;

// One option, or the arguments that are no option.
typedef struct OptionRow {
    const char *name;
    const char *value; // what --help calls it; "FILE..." is a file that the command writes
    const char *doc;
    int group; // of --help
    OptionType type;
    size_t offset;       // in the command's options
    size_t count_offset; // of a list: how many there are, a size_t
    double low, high;
    Dimension dimension;
    // Of a choice: those that there are; of a list between commas: those that completion offers.
    // Ends in NULL.
    const char *const *words;
    const char *what; // in messages: what a list is of, or "map takes one case"
    int letter;       // the short option; 0: none
    // The value is NULL for an option without one. May fail with ERR_USAGE.
    bool (*read)(const char *value, void *options, Err *err);
} OptionRow;

typedef struct Arguments {
    const char *program; // as in a message: "jointplay run"
    const char *usage;   // of what is no option: "CASE..."
    const char *doc;     // what the command does; behind a \v, more of it
    OptionRow argument;  // what is no option; a text may be given once
    const OptionRow *options;
    size_t option_count; // without --help, which every command has
    // Whether what was given goes together; NULL: it always does. May fail with ERR_USAGE.
    bool (*check)(void *options, Err *err);
} Arguments;

// A table of rows, in the initializer of Arguments.
#define OPTION_ROWS(rows) .options = (rows), .option_count = sizeof(rows) / sizeof *(rows)

// Reads a command line into the options, a structure that holds the defaults, and does the work
// with them. Options and arguments may come in any order. Where --help is among them it is printed,
// and nothing else is done. Fails with ERR_USAGE, or as the work does; an option that does not
// exist is answered with the one that may have been meant.
bool arguments_run(const Arguments *arguments, int argc, char **argv, void *options,
                   bool (*work)(void *options, Err *err), Err *err);

// A command of the program: a folder of commands/ each, all listed in main.c.
#pragma once

#include "base/err.h"
#include "base/text.h"
#include "cli/arguments.h"

#include <stdbool.h>

typedef struct Command {
    const char *name;
    const char *summary; // one line for people
    // Does it. argv[0] is the command's name. Data go to standard output, words to standard error;
    // an error is only set, never printed.
    bool (*run)(int argc, char **argv, Err *err);
    // Appends the format of the file that it reads, for 'jointplay help'. NULL: it has none of its
    // own.
    void (*describe)(bool is_markdown, Text *text);
    // Its command line, of which help, completion and man page are made.
    const Arguments *arguments;
    // Commands of its own, such as 'study status'; ends in NULL. NULL: it has none.
    const struct Command *const *parts;
} Command;

// All of them, in the order in which they are listed; ends in NULL.
extern const Command *const COMMANDS[];

// The command of a name. Fails with ERR_USAGE, naming the command that may have been meant.
const Command *command_find(const char *name, Err *err);

// The same, with a topic that is no command among the names that may have been meant.
const Command *command_find_topic(const char *name, const char *topic, Err *err);

// Prints what the program does and the list of commands.
void command_list(void);

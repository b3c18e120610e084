// What `jointplay help` makes of the tables of all commands for other programs.
#pragma once

#include "cli/command.h"

// What stands for the value of an option, or for an argument, on a command line.
typedef enum HelpValue {
    HELP_VALUE_NONE,   // no value
    HELP_VALUE_WORDS,  // one of a row's words
    HELP_VALUE_LIST,   // several of them between commas
    HELP_VALUE_KEYS,   // KEY=VALUE, a key of the case
    HELP_VALUE_FILE,   // a file that is written
    HELP_VALUE_FOLDER, // a folder
    HELP_VALUE_OTHER,  // something that nobody can guess
} HelpValue;

HelpValue help_value_of(const OptionRow *row);

// Calls `visit` for every command, and for every command of its own behind it: "study",
// "study status".
void help_visit(void (*visit)(const Command *command, const char *name, void *target),
                void *target);

// Appends a script that completes command lines of jointplay in bash or in zsh.
void help_completion_bash(Text *text);
void help_completion_zsh(Text *text);

// Appends a manual page in roff: of a command, with those of its own, or, of NULL, of the program.
void help_man(const Command *command, Text *text);

// What the manual says of an option beside its row, or NULL. "study status" has its own name.
const char *help_notes_find(const char *command, const char *option);

// Whether every line of that is of a command or an option that there is.
bool help_notes_are_of_options(void);

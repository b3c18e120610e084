// Finds a command by its name, and lists them.
#include "cli/command.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

enum { COMMAND_MAX = 32 };

// What other programs call a command, and what it is here.
typedef struct CommandHabit {
    const char *theirs;
    const char *ours;
} CommandHabit;

static const CommandHabit HABITS[] = {
    {"plot", "jointplay report"},    {"show", "jointplay report"},
    {"simulate", "jointplay run"},   {"solve", "jointplay run"},
    {"init", "jointplay new"},       {"create", "jointplay new"},
    {"sweep", "jointplay study"},    {"test", "jointplay check"},
    {"validate", "jointplay check"}, {"version", "jointplay --version"},
};

static const char *find_habit(const char *name)
{
    for (size_t i = 0; i < sizeof HABITS / sizeof *HABITS; i++) {
        if (strcmp(HABITS[i].theirs, name) == 0) {
            return HABITS[i].ours;
        }
    }
    return NULL;
}

const Command *command_find(const char *name, Err *err)
{
    return command_find_topic(name, NULL, err);
}

const Command *command_find_topic(const char *name, const char *topic, Err *err)
{
    const char *names[COMMAND_MAX + 1];
    size_t count = 0;
    for (; COMMANDS[count] != NULL; count++) {
        names[count] = COMMANDS[count]->name;
        if (strcmp(name, names[count]) == 0) {
            return COMMANDS[count];
        }
    }
    if (topic != NULL) {
        names[count++] = topic;
    }
    const char *habit = find_habit(name);
    const char *nearest = habit != NULL ? habit : text_nearest(name, names, count);
    const char *ending = strrchr(name, '.');
    if (ending != NULL && (strcmp(ending, ".yaml") == 0 || strcmp(ending, ".yml") == 0)) {
        err_set(err, ERR_USAGE, "'%s' is no command; did you mean 'jointplay run %s'?", name, name);
    } else if (nearest != NULL) {
        err_set(err, ERR_USAGE, "unknown command '%s'; did you mean '%s'?", name, nearest);
    } else {
        err_set(err, ERR_USAGE, "unknown command '%s'; 'jointplay help' lists the commands", name);
    }
    return NULL;
}

void command_list(void)
{
    printf("jointplay: how far can ODE be trusted with a joint that has play, at what cost?\n\n"
           "Usage: jointplay COMMAND [OPTION...] [ARGUMENT...]\n\nCommands:\n");
    for (size_t i = 0; COMMANDS[i] != NULL; i++) {
        printf("  %-8s %s\n", COMMANDS[i]->name, COMMANDS[i]->summary);
    }
    printf("\n'jointplay COMMAND --help' explains a command, 'jointplay help case' the format\n"
           "of a case file; 'jointplay --version' prints the versions at work.\n"
           "\nExit status: 0 done, 1 the numbers differ, 2 usage, 3 bad case file, 4 a solver\n"
           "failed, 5 a file could not be read or written.\n");
}

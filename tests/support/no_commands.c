// The layers without the program: it has no commands.
#include "cli/command.h"

#include <stddef.h>

const Command *const COMMANDS[] = {NULL};

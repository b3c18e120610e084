// The commands that there are: a folder each. cli/main.c lists them.
#pragma once

#include "cli/command.h"

extern const Command cmd_run;
extern const Command cmd_compare;
extern const Command cmd_check;
extern const Command cmd_tune;
extern const Command cmd_map;
extern const Command cmd_study;
extern const Command cmd_paper;
extern const Command cmd_report;
extern const Command cmd_new;
extern const Command cmd_help;

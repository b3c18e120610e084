// What is chosen on the command line of a case that is run: backends, step and settings.
#pragma once

#include "cli/common_options.h"
#include "commands/run/case_run.h"

// The first member of the options of a command that has the rows below.
typedef struct RunChoices {
    CommonOptions common;
    char *owned[OPTION_SETTING_MAX]; // of the settings, those that --step, --budget and --backend
                                     // stand for
    size_t owned_count;
    Text backends; // names, separated by commas
    bool is_uncertified;
    bool is_quick; // without the range over the inputs
} RunChoices;

// Rows of a list of options, in a group of its help.
// clang-format off
#define RUN_CHOICES(help_group) \
    {"backend", "NAME[,NAME]", "Run on these instead of the case's run.backends", help_group, \
     OPTION_READ, .read = run_choices_read_backend, .words = OPTIONS_BACKENDS}, \
    {"step", "TIME", "The step, such as '2 us': short for --set run.step=TIME", help_group, \
     OPTION_READ, .read = run_choices_read_step}, \
    {"budget", "TIME", "Processor time of each engine and of draws, or none: short for --set run.budget=TIME", \
     help_group, OPTION_READ, .read = run_choices_read_budget}, \
    COMMON_SET(help_group), \
    COMMON_DRIVERS(help_group), \
    COMMON_TIME_LIMIT(help_group, "A driver's run that takes longer has failed (default: 600 s)"), \
    {"uncertified", NULL, \
     "Run the reference alone, in a fifth of the time: its uncertainty and horizon are not known", \
     help_group, OPTION_FLAG, .offset = offsetof(RunChoices, is_uncertified)}, \
    {"quick", NULL, "Leave out how far the inputs' limits and other assumptions move the forces", \
     help_group, OPTION_FLAG, .offset = offsetof(RunChoices, is_quick)}
// clang-format on
bool run_choices_read_backend(const char *names, void *choices, Err *err);
bool run_choices_read_step(const char *step, void *choices, Err *err);
bool run_choices_read_budget(const char *budget, void *choices, Err *err);

// Before the command line is read, once all of it has been (ERR_USAGE), and when all is done.
void run_choices_begin(RunChoices *choices);
bool run_choices_end(RunChoices *choices, Err *err);
void run_choices_finish(RunChoices *choices);

// Loads a case with what was chosen into a run that is all zero. Fails as casefile_load does, with
// ERR_USAGE where --uncertified does not go with a step that is chosen by its error, and with
// ERR_CASE where a backend cannot run it.
bool run_choices_load(const RunChoices *choices, const char *path, CaseRun *run, Err *err);

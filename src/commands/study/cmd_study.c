// How do results change over ranges of a case's values?
#include "base/text.h"
#include "commands/study/study_commands.h"
#include "commands/study/study_options.h"
#include "commands/study/study_place.h"
#include "commands/study/study_run.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const Command *const PARTS[] = {&study_command_status, &study_command_export,
                                       &study_command_merge, &study_command_plot,
                                       &study_command_slurm};
enum { PART_COUNT = sizeof PARTS / sizeof *PARTS };

static const Command *find_part(const char *word)
{
    for (size_t i = 0; i < PART_COUNT; i++) {
        if (strcmp(PARTS[i]->name, word) == 0) {
            return PARTS[i];
        }
    }
    return NULL;
}

// A word that is no file may have been meant as a command.
static bool check_word(const char *word, Err *err)
{
    const char *names[PART_COUNT];
    for (size_t i = 0; i < PART_COUNT; i++) {
        names[i] = PARTS[i]->name;
    }
    const char *nearest = text_nearest(word, names, PART_COUNT);
    return nearest == NULL || access(word, F_OK) == 0 ||
           err_set(err, ERR_USAGE, "there is no study file %s; did you mean 'jointplay study %s'?",
                   word, nearest);
}

static bool run(int argc, char **argv, Err *err)
{
    const Command *part = argc > 1 ? find_part(argv[1]) : NULL;
    if (part != NULL) {
        return part->run(argc - 1, argv + 1, err);
    }
    if (argc > 1 && argv[1][0] != '-' && !check_word(argv[1], err)) {
        return false;
    }
    StudyOptions options = study_options_default();
    return arguments_run(&STUDY_ARGUMENTS, argc, argv, &options, study_run, err);
}

const Command cmd_study = {
    .name = "study",
    .summary = "sweeps values of a case into a store; resumes where it was stopped",
    .run = run,
    .describe = spec_describe,
};

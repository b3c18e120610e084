// How do results change over ranges of a case's values? What `jointplay study` was asked for.
#include "base/text.h"
#include "casefile/quantity.h"
#include "commands/study/study_commands.h"
#include "commands/study/study_path.h"
#include "commands/study/sweep.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NUMBER_SIZE = 24 };

// "2/3" is the second of three.
static bool read_shard(const char *text, void *options, Err *err)
{
    const char *slash = strchr(text, '/');
    char first[NUMBER_SIZE] = "";
    size_t index = 0;
    size_t count = 0;
    Complaint complaint;
    if (slash != NULL && slash - text < NUMBER_SIZE) {
        snprintf(first, sizeof first, "%.*s", (int)(slash - text), text);
    }
    if (slash == NULL || !quantity_integer(first, &index, &complaint) ||
        !quantity_integer(slash + 1, &count, &complaint) || index < 1 || index > count) {
        return err_set(err, ERR_USAGE,
                       "--shard is %s; allowed: I/N, the I-th of N parts, such as 1/4 to 4/4",
                       text);
    }
    if (count > DESIGN_SHARD_MAX) {
        return err_set(err, ERR_USAGE, "--shard is %s; allowed: at most %d parts", text,
                       DESIGN_SHARD_MAX);
    }
    ((StudyOptions *)options)->shard = (Shard){index - 1, count};
    return true;
}

static bool read_store(const char *path, void *target, Err *err)
{
    StudyOptions *options = target;
    return snprintf(options->store, sizeof options->store, "%s", path) <
               (int)sizeof options->store ||
           err_set(err, ERR_USAGE, "--store: the path is too long");
}

#define AT(field) .offset = offsetof(StudyOptions, field)

static const OptionRow OPTIONS[] = {
    {"jobs", "N", "Runs at a time (default: one per core)", 1, OPTION_COUNT, AT(common.jobs),
     .low = 1, .high = SWEEP_JOB_MAX},
    {"shard", "I/N", "Only the I-th of N parts, into a store of its own", 1, OPTION_READ,
     .read = read_shard},
    {"store", "FILE", "Keep the runs there (default: <study>.sqlite in the working folder)", 1,
     OPTION_READ, .read = read_store},
    {"fresh", NULL, "Discard the contents of the store", 1, OPTION_FLAG, AT(is_fresh)},
    {"retry-failed", NULL, "Repeat the runs that failed or whose rows are damaged", 1, OPTION_FLAG,
     AT(is_retrying)},
    {"dry-run", NULL, "Print what would be run, and run nothing", 2, OPTION_FLAG, AT(is_dry)},
    COMMON_JSON(2),
    COMMON_WIDE(2),
    COMMON_QUIET(2),
};

static bool check(void *target, Err *err)
{
    StudyOptions *options = target;
    if (options->common.path == NULL) {
        return err_set(err, ERR_USAGE, "no study given: jointplay study STUDY.yaml");
    }
    if (strcmp(options->common.path, "-") == 0) {
        return err_set(err, ERR_USAGE,
                       "study takes a file and not standard input: its store has the file's name");
    }
    if (options->is_fresh && options->is_retrying) {
        return err_set(err, ERR_USAGE,
                       "--fresh makes all runs again, --retry-failed only some: "
                       "one of them, not both");
    }
    return options->store[0] != '\0' ||
           study_path_store(options->common.path, options->shard, options->store, err);
}

static const Arguments ARGUMENTS = {
    .program = "jointplay study",
    .usage = "FILE\nstatus FILE-or-STORE...\nexport FILE-or-STORE\nmerge FILE\n"
             "merge OUT.sqlite IN.sqlite...\nplot FILE-or-STORE FILE.svg\nslurm FILE",
    .doc = "Makes the runs of a study that its store does not hold yet, each in its own process, "
           "and keeps them in the store."
           "\vA study that is stopped at any moment resumes with the same command. 'jointplay "
           "study status --help' and so on explain the other words.",
    .argument = COMMON_PATH("study takes one file"),
    OPTION_ROWS(OPTIONS),
    .check = check,
};

bool study_words_read(const char *word, void *target, Err *err)
{
    (void)err;
    StudyWords *words = target;
    words->words[words->count++] = word;
    return true;
}

bool study_words_run(const Arguments *arguments, int argc, char **argv,
                     bool (*work)(void *words, Err *err), Err *err)
{
    // no command line has more words than it has arguments
    StudyWords words = {.words = calloc((size_t)argc, sizeof *words.words)};
    assert(words.words != NULL);
    const bool is_done = arguments_run(arguments, argc, argv, &words, work, err);
    free(words.words);
    return is_done;
}

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
    _Static_assert((int)SWEEP_JOB_MAX >= (int)OPTION_JOB_MAX, "a default that is refused");
    StudyOptions options = {.common.jobs = common_options_count_jobs(), .shard = {0, 1}};
    return arguments_run(&ARGUMENTS, argc, argv, &options, study_run, err);
}

const Command cmd_study = {
    .name = "study",
    .summary = "sweeps values of a case into a store; resumes where it was stopped",
    .run = run,
    .describe = spec_describe,
};

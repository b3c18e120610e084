// What was `jointplay study FILE` asked for?
#include "commands/study/study_options.h"

#include "casefile/quantity.h"
#include "commands/study/study_place.h"
#include "commands/study/sweep.h"

#include <stdio.h>
#include <string.h>

enum { NUMBER_SIZE = 24 };

bool study_options_read_shard(const char *text, Shard *shard, Err *err)
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
    *shard = (Shard){index - 1, count};
    return true;
}

static bool read_shard(const char *text, void *options, Err *err)
{
    return study_options_read_shard(text, &((StudyOptions *)options)->shard, err);
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
    {"jobs", "N", "Runs at a time (default: one a core)", 1, OPTION_COUNT, AT(common.jobs),
     .low = 1, .high = SWEEP_JOB_MAX},
    {"shard", "I/N", "Only the I-th of N parts, into a store of its own", 1, OPTION_READ,
     .read = read_shard},
    {"store", "FILE", "Keep the runs there (default: <study>.sqlite in the working folder)", 1,
     OPTION_READ, .read = read_store},
    {"fresh", NULL, "Forget what the store holds", 1, OPTION_FLAG, AT(is_fresh)},
    {"retry-failed", NULL, "Make the runs again that failed or whose rows are damaged", 1,
     OPTION_FLAG, AT(is_retrying)},
    {"dry-run", NULL, "Say what would be run, and run nothing", 2, OPTION_FLAG, AT(is_dry)},
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
           study_place_store(options->common.path, options->shard, options->store, err);
}

const Arguments STUDY_ARGUMENTS = {
    .program = "jointplay study",
    .usage = "FILE\nstatus FILE-or-STORE...\nexport FILE-or-STORE\nmerge FILE\n"
             "merge OUT.sqlite IN.sqlite...\nplot FILE-or-STORE FILE.svg\nslurm FILE",
    .doc = "Makes the runs of a study that its store does not hold yet, each in a process of "
           "its own, and keeps them in the store."
           "\vWhoever ends the program at any moment goes on where it stood with the same "
           "command. 'jointplay study status --help' and so on tell more of the others.",
    .argument = COMMON_PATH("study takes one file"),
    OPTION_ROWS(OPTIONS),
    .check = check,
};

StudyOptions study_options_default(void)
{
    _Static_assert((int)SWEEP_JOB_MAX >= (int)OPTION_JOB_MAX, "a default that is refused");
    return (StudyOptions){.common.jobs = common_options_count_jobs(), .shard = {0, 1}};
}

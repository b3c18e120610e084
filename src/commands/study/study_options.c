// What was `jointplay study FILE` asked for?
#include "commands/study/study_options.h"

#include "casefile/quantity.h"
#include "cli/arguments.h"
#include "cli/option_values.h"
#include "commands/study/study_place.h"
#include "commands/study/sweep.h"

#include <stdio.h>
#include <string.h>

enum {
    KEY_SHARD = 0x200, // options without a letter of their own
    KEY_STORE,
    KEY_FRESH,
    KEY_RETRY,
    KEY_DRY,
};

enum { NUMBER_SIZE = 24 };

static const struct argp_option OPTIONS[] = {
    {"jobs", COMMON_JOBS, "N", 0, "Runs at a time (default: one a core)", 1},
    {"shard", KEY_SHARD, "I/N", 0, "Only the I-th of N parts, into a store of its own", 1},
    {"store", KEY_STORE, "FILE", 0,
     "Keep the runs there (default: <study>.sqlite in the working folder)", 1},
    {"fresh", KEY_FRESH, NULL, 0, "Forget what the store holds", 1},
    {"retry-failed", KEY_RETRY, NULL, 0,
     "Make the runs again that failed or whose rows are damaged", 1},
    {"dry-run", KEY_DRY, NULL, 0, "Say what would be run, and run nothing", 2},
    COMMON_ROW_JSON(2),
    COMMON_ROW_WIDE(2),
    COMMON_ROW_QUIET(2),
    {0},
};

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

static bool take_store(StudyOptions *options, const char *path, Err *err)
{
    return snprintf(options->store, sizeof options->store, "%s", path) <
               (int)sizeof options->store ||
           err_set(err, ERR_USAGE, "--store: the path is too long");
}

static bool take_option(int key, const char *value, void *target, Err *err)
{
    StudyOptions *options = target;
    switch (key) {
    case COMMON_JOBS:
        return option_values_read_count("jobs", value, 1, SWEEP_JOB_MAX, &options->common.jobs,
                                        err);
    case KEY_SHARD:
        return study_options_read_shard(value, &options->shard, err);
    case KEY_STORE:
        return take_store(options, value, err);
    case KEY_FRESH:
        options->is_fresh = true;
        return true;
    case KEY_RETRY:
        options->is_retrying = true;
        return true;
    case KEY_DRY:
        options->is_dry = true;
        return true;
    case ARGP_KEY_ARG:
        return common_options_take_path(value, &options->common, "study takes one file", err);
    default:
        return common_options_take(key, value, &options->common, err);
    }
}

bool study_options_read(int argc, char **argv, StudyOptions *options, bool *is_answered, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay study",
        .usage = "FILE\nstatus FILE-or-STORE...\nexport FILE-or-STORE\nmerge FILE\n"
                 "merge OUT.sqlite IN.sqlite...\nplot FILE-or-STORE FILE.svg\nslurm FILE",
        .doc = "Makes the runs of a study that its store does not hold yet, each in a process of "
               "its own, and keeps them in the store."
               "\vWhoever ends the program at any moment goes on where it stood with the same "
               "command. 'jointplay study status --help' and so on tell more of the others.",
        .options = OPTIONS,
        .take = take_option,
    };
    _Static_assert((int)SWEEP_JOB_MAX >= (int)OPTION_JOB_MAX, "a default that is refused");
    *options = (StudyOptions){.common.jobs = option_values_count_jobs(), .shard = {0, 1}};
    if (!arguments_parse(&ARGUMENTS, argc, argv, options, is_answered, err)) {
        return false;
    }
    if (*is_answered) {
        return true;
    }
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

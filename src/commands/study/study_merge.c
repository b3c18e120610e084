// How do the shards of a study become one store?
#include "base/shell.h"
#include "cli/arguments.h"
#include "cli/output.h"
#include "commands/study/store.h"
#include "commands/study/study_commands.h"
#include "commands/study/study_path.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const OptionRow OPTIONS[] = {
    {"quiet", NULL, "Nothing on standard error but errors", 1, OPTION_FLAG,
     .offset = offsetof(StudyWords, is_quiet), .letter = 'q'},
};

// What there is in a store now.
static bool say_count(const char *path, uint64_t added, bool is_quiet, Err *err)
{
    StoreCount count = {0};
    Store *store = store_view(path, err);
    const bool is_counted = store != NULL && store_count(store, &count, err);
    if (is_counted && !is_quiet) {
        output_say("merged %" PRIu64 " runs into %s, which holds %" PRIu64 " of %" PRIu64 "\n",
                   added, path, count.rows, count.run_count);
    }
    return store_close(store, err) && is_counted;
}

static bool merge(const char *target, const char *const *sources, size_t count, bool is_quiet,
                  Err *err)
{
    uint64_t added;
    return store_merge(target, sources, count, &added, err) &&
           say_count(target, added, is_quiet, err);
}

// The usual name of a shard's store, which must be there.
static char *find_shard(const char *study, Shard shard, Err *err)
{
    char path[FILE_PATH_SIZE];
    if (!study_path_store(study, shard, path, err) ||
        (access(path, F_OK) != 0 &&
         !err_set(err, ERR_FILE,
                  "there is no %s in the working folder; make it with --shard %" PRIu64 "/%" PRIu64
                  ", or name the stores to be merged",
                  path, shard.index + 1, shard.count))) {
        return NULL;
    }
    char *copy = strdup(path);
    assert(copy != NULL);
    return copy;
}

static bool merge_shards(const char *study, uint64_t shards, const char *target, bool is_quiet,
                         Err *err)
{
    char **paths = calloc(shards, sizeof *paths);
    assert(paths != NULL);
    bool are_there = true;
    for (uint64_t i = 0; i < shards && are_there; i++) {
        paths[i] = find_shard(study, (Shard){i, shards}, err);
        are_there = paths[i] != NULL;
    }
    const bool is_merged =
        are_there && merge(target, (const char *const *)paths, shards, is_quiet, err);
    for (uint64_t i = 0; i < shards; i++) {
        free(paths[i]);
    }
    free(paths);
    return is_merged;
}

// All shards of a study file, by their usual names.
static bool merge_study(const char *study, bool is_quiet, Err *err)
{
    char target[FILE_PATH_SIZE];
    uint64_t shards;
    if (!study_path_store(study, (Shard){0, 1}, target, err) ||
        !study_path_count_shards(study, &shards, err)) {
        return false;
    }
    if (shards == 0) {
        char shard[FILE_PATH_SIZE];
        if (study_path_store(study, (Shard){0, 2}, shard, err)) {
            char *path = shell_copy_path(study);
            err_set(err, ERR_FILE,
                    "there are no parts of %s in the working folder, such as %s; 'jointplay "
                    "study %s --shard 1/2' makes one",
                    study, shard, path);
            free(path);
        }
        return false;
    }
    return merge_shards(study, shards, target, is_quiet, err);
}

// A study file alone, or a store and those that go into it.
static bool merge_words(void *target, Err *err)
{
    const StudyWords *words = target;
    if (words->count == 1 && study_path_is_study(words->words[0])) {
        return merge_study(words->words[0], words->is_quiet, err);
    }
    if (words->count > 1 && study_path_is_study(words->words[0])) {
        return err_set(err, ERR_USAGE,
                       "%s is a study file, and stores are merged into a store: jointplay study "
                       "merge OUT.sqlite IN.sqlite...",
                       words->words[0]);
    }
    if (words->count < 2) {
        return err_set(err, ERR_USAGE,
                       "nothing to merge given: jointplay study merge STUDY.yaml, or "
                       "jointplay study merge OUT.sqlite IN.sqlite...");
    }
    return merge(words->words[0], words->words + 1, words->count - 1, words->is_quiet, err);
}

static bool run(int argc, char **argv, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay study merge",
        .usage = "FILE\nOUT.sqlite IN.sqlite...",
        .doc = "Merges the shards of a study into one store: those of a study file by their usual "
               "names in the working folder, or those that are named."
               "\vRuns that are there already are left alone. Stores of different studies or "
               "programs are refused, and nothing is written then.",
        .argument = {.type = OPTION_READ, .read = study_words_read},
        OPTION_ROWS(OPTIONS),
    };
    return study_words_run(&ARGUMENTS, argc, argv, merge_words, err);
}

const Command study_command_merge = {
    .name = "merge",
    .summary = "the shards of a study into one store",
    .run = run,
};

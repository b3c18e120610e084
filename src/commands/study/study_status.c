// How far has a study come?
#include "cli/arguments.h"
#include "cli/output.h"
#include "commands/study/study_commands.h"
#include "commands/study/study_path.h"
#include "commands/study/study_text.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Stores of one study, whether they are there or not.
typedef struct Parts {
    size_t count;
    size_t room;
    StudyPart *parts; // owned, as their stores are and their paths
} Parts;

static const OptionRow OPTIONS[] = {
    {"wide", NULL, "All columns of the tables, however wide the terminal is", 0, OPTION_FLAG,
     .offset = offsetof(StudyWords, is_wide)},
};

// In place of the number of runs that a store is to hold: only the store itself knows. A part of a
// study with fewer runs than parts is to hold none.
static const uint64_t WANTED_UNKNOWN = UINT64_MAX;

// Adds a store; one that is not there holds nothing yet.
static bool add_part(Parts *parts, const char *path, uint64_t wanted, Err *err)
{
    if (parts->count == parts->room) {
        parts->room = 2 * parts->room + 1;
        parts->parts = realloc(parts->parts, parts->room * sizeof *parts->parts);
        assert(parts->parts != NULL);
    }
    StudyPart *part = &parts->parts[parts->count];
    StoreCount count = {0};
    *part = (StudyPart){.wanted = wanted};
    if (wanted == WANTED_UNKNOWN || access(path, F_OK) == 0) {
        part->store = store_view(path, err);
        if (part->store == NULL) {
            return false;
        }
    }
    part->path = strdup(path);
    assert(part->path != NULL);
    parts->count++;
    if (wanted == WANTED_UNKNOWN && !store_count(part->store, &count, err)) {
        return false;
    }
    part->wanted = wanted == WANTED_UNKNOWN ? count.run_count : wanted;
    return true;
}

static bool finish_parts(Parts *parts, Err *err)
{
    bool is_closed = true;
    for (size_t i = 0; i < parts->count; i++) {
        is_closed = store_close(parts->parts[i].store, err) && is_closed;
        free((void *)parts->parts[i].path);
    }
    free(parts->parts);
    return is_closed;
}

// The store of the whole study, and behind it those of its shards where there are any.
static bool add_study(Parts *parts, const char *study, Err *err)
{
    uint64_t shards;
    char path[FILE_PATH_SIZE];
    Spec *spec = spec_open(study, err);
    bool is_added = spec != NULL && study_path_count_shards(study, &shards, err) &&
                    study_path_store(study, (Shard){0, 1}, path, err);
    // a store of all is what the parts were merged into, or are to be
    if (is_added && (shards == 0 || access(path, F_OK) == 0)) {
        is_added = add_part(parts, path, design_run_count(spec), err);
        shards = 0;
    }
    for (uint64_t i = 0; is_added && i < shards; i++) {
        const Shard shard = {i, shards};
        is_added = study_path_store(study, shard, path, err) &&
                   add_part(parts, path, design_shard_count(spec, shard), err);
    }
    spec_close(spec);
    return is_added;
}

static bool print_parts(const Parts *parts, bool is_wide, Err *err)
{
    Text text;
    text_init(&text);
    const Style style = output_style(stdout, is_wide);
    const bool is_written = study_text_status(parts->parts, parts->count, &style, &text, err);
    if (is_written) {
        output_text(&text, &style);
    }
    text_finish(&text);
    return is_written;
}

static bool tell(void *target, Err *err)
{
    const StudyWords *words = target;
    if (words->count == 0) {
        return err_set(err, ERR_USAGE, "no study given: jointplay study status STUDY.yaml");
    }
    bool is_told = true;
    for (size_t i = 0; i < words->count && is_told; i++) {
        Parts parts = {0};
        const char *word = words->words[i];
        is_told = (study_path_is_study(word) ? add_study(&parts, word, err)
                                             : add_part(&parts, word, WANTED_UNKNOWN, err)) &&
                  print_parts(&parts, words->is_wide, err);
        is_told = finish_parts(&parts, err) && is_told;
    }
    return is_told;
}

static bool run(int argc, char **argv, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay study status",
        .usage = "FILE-or-STORE...",
        .doc = "Shows how far a study has come. For a study file, the stores of the usual names in "
               "the working folder are read. The study may be running meanwhile.",
        .argument = {.type = OPTION_READ, .read = study_words_read},
        OPTION_ROWS(OPTIONS),
    };
    return study_words_run(&ARGUMENTS, argc, argv, tell, err);
}

const Command study_command_status = {
    .name = "status",
    .summary = "how far a study has come",
    .run = run,
};

// The command `jointplay study`: its options, and the commands status, merge, export, plot and the
// dry run. What `jointplay study` was asked for.
#include "base/shell.h"
#include "base/text.h"
#include "casefile/quantity.h"
#include "casefile/source.h"
#include "cli/arguments.h"
#include "cli/option_values.h"
#include "cli/output.h"
#include "cli/status_line.h"
#include "cli/written.h"
#include "commands/study/store.h"
#include "commands/study/study.h"
#include "commands/study/study_plot.h"
#include "commands/study/sweep.h"
#include "write/file.h"
#include "write/table.h"
#include "write/units.h"

#include <assert.h>
#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool study_words_read(const char *word, void *target, Err *err);
static bool study_words_run(const Arguments *arguments, int argc, char **argv,
                            bool (*work)(void *words, Err *err), Err *err);

// Where the store of a study is.

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash == NULL ? path : slash + 1;
}

static int stem_length(const char *study)
{
    const char *base = base_name(study);
    const char *dot = strrchr(base, '.');
    return (int)(dot == NULL || dot == base ? strlen(base) : (size_t)(dot - base));
}

bool study_path_name(const char *study, Shard shard, char name[FILE_PATH_SIZE], Err *err)
{
    const int length =
        shard.count == 1
            ? snprintf(name, FILE_PATH_SIZE, "%.*s.sqlite", stem_length(study), base_name(study))
            : snprintf(name, FILE_PATH_SIZE, "%.*s.%" PRIu64 "-of-%" PRIu64 ".sqlite",
                       stem_length(study), base_name(study), shard.index + 1, shard.count);
    return length < FILE_PATH_SIZE ||
           err_set(err, ERR_FILE, "the path of the store of %s is too long", study);
}

// The N of <stem>.I-of-N.sqlite, 1 of <stem>.sqlite; 0 where the name is another.
static uint64_t study_path_shards_of(const char *study, const char *name)
{
    const size_t stem = (size_t)stem_length(study);
    uint64_t index = 1;
    uint64_t count = 1;
    char made[FILE_PATH_SIZE];
    Err err = {0};
    if (strncmp(name, base_name(study), stem) != 0 ||
        (strcmp(name + stem, ".sqlite") != 0 &&
         sscanf(name + stem, ".%" SCNu64 "-of-%" SCNu64 ".sqlite", &index, &count) != 2)) {
        return 0;
    }
    // it is the name only if it would be made just so
    const bool is_name = index >= 1 && index <= count && count <= DESIGN_SHARD_MAX &&
                         study_path_name(study, (Shard){index - 1, count}, made, &err) &&
                         strcmp(made, name) == 0;
    return is_name ? count : 0;
}

// The folder of a study file, with a slash at its end; empty where that is the working folder.
static void study_path_own_folder(const char *study, char folder[FILE_PATH_SIZE])
{
    text_copy(folder, FILE_PATH_SIZE, study);
    folder[FILE_PATH_SIZE - 1] = '\0';
    char *slash = strrchr(folder, '/');
    *(slash == NULL ? folder : slash + 1) = '\0';
}

static bool has_stores(const char *study, const char *path)
{
    DIR *folder = opendir(path[0] == '\0' ? "." : path);
    bool is_any = false;
    for (const struct dirent *entry;
         folder != NULL && !is_any && (entry = readdir(folder)) != NULL;) {
        is_any = study_path_shards_of(study, entry->d_name) > 0;
    }
    if (folder != NULL) {
        closedir(folder);
    }
    return is_any;
}

// Where the stores of a study are: in the working folder, unless there is none and some are beside
// the study file. Every command asks here, so that the one finds what the other wrote. As above.
static void study_path_folder(const char *study, char folder[FILE_PATH_SIZE])
{
    study_path_own_folder(study, folder);
    if (folder[0] != '\0' && (has_stores(study, "") || !has_stores(study, folder))) {
        folder[0] = '\0';
    }
}

bool study_path_store(const char *study, Shard shard, char path[FILE_PATH_SIZE], Err *err)
{
    char folder[FILE_PATH_SIZE];
    char name[FILE_PATH_SIZE];
    study_path_folder(study, folder);
    if (!study_path_name(study, shard, name, err)) {
        return false;
    }
    const size_t length = strlen(folder);
    text_copy(path, FILE_PATH_SIZE, folder);
    text_copy(path + length, FILE_PATH_SIZE - length, name);
    return length + strlen(name) < FILE_PATH_SIZE ||
           err_set(err, ERR_FILE, "the path of the store of %s is too long", study);
}

// Where a store is looked for: "in the working folder", and in that of the study file.
static void study_path_append_places(const char *study, Text *text)
{
    char folder[FILE_PATH_SIZE];
    study_path_own_folder(study, folder);
    text_append(text, "in the working folder");
    if (folder[0] != '\0') {
        text_append(text, " or in ");
        text_append_shown(text, folder);
    }
}

bool study_path_is_study(const char *word)
{
    const char *dot = strrchr(base_name(word), '.');
    return dot != NULL && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0);
}

// There is no store of a study yet.
static bool refuse_place(const char *study, const char *path, Err *err)
{
    Text places;
    text_init(&places);
    study_path_append_places(study, &places);
    err_set(err, ERR_FILE, "there is no %s %s; 'jointplay study' with the study file makes it",
            path, places.data);
    text_finish(&places);
    return false;
}

bool study_path_find(const char *word, char path[FILE_PATH_SIZE], Err *err)
{
    if (study_path_is_study(word)) {
        return study_path_store(word, (Shard){0, 1}, path, err) &&
               (access(path, F_OK) == 0 || refuse_place(word, path, err));
    }
    return snprintf(path, FILE_PATH_SIZE, "%s", word) < FILE_PATH_SIZE ||
           err_set(err, ERR_FILE, "the path of the store is too long");
}

// How many parts a study was divided into, by the stores that are where its own are; 0 where there
// are no parts. Fails with ERR_FILE where there are parts of several such divisions.
static bool study_path_count_shards(const char *study, uint64_t *shards, Err *err)
{
    char path[FILE_PATH_SIZE];
    study_path_folder(study, path);
    *shards = 0;
    DIR *folder = opendir(path[0] == '\0' ? "." : path);
    if (folder == NULL) {
        return true;
    }
    bool are_alike = true;
    for (const struct dirent *entry; are_alike && (entry = readdir(folder)) != NULL;) {
        const uint64_t found = study_path_shards_of(study, entry->d_name);
        const uint64_t count = found > 1 ? found : 0;
        are_alike =
            count == 0 || *shards == 0 || count == *shards ||
            err_set(err, ERR_FILE,
                    "there are stores of %" PRIu64 " and of %" PRIu64
                    " parts of %s here; take those of one away, or name the stores",
                    count < *shards ? count : *shards, count < *shards ? *shards : count, study);
        *shards = count > 0 ? count : *shards;
    }
    closedir(folder);
    return are_alike;
}

// study status: how far a study is.

// Stores of one study, whether they are there or not.
typedef struct Parts {
    size_t count;
    size_t room;
    StudyPart *parts; // owned, as their stores are and their paths
    Text places;      // where the one that is not there was looked for
} Parts;

static const OptionRow STUDY_STATUS_OPTIONS[] = {
    {"wide", NULL, "All columns of the tables, however wide the terminal is", 0, OPTION_FLAG,
     .offset = offsetof(StudyWords, is_wide)},
};

// In place of the number of runs that a store is to hold: only the store itself knows. A part of a
// study with fewer runs than parts is to hold none.
static const uint64_t WANTED_UNKNOWN = UINT64_MAX;

// Adds a store; one that is not there holds nothing yet.
static bool cmd_study_add_part(Parts *parts, const char *path, uint64_t wanted, Err *err)
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
    text_finish(&parts->places);
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
        is_added = cmd_study_add_part(parts, path, design_run_count(spec), err);
        shards = 0;
        study_path_append_places(study, &parts->places);
    }
    for (uint64_t i = 0; is_added && i < shards; i++) {
        const Shard shard = {i, shards};
        is_added = study_path_store(study, shard, path, err) &&
                   cmd_study_add_part(parts, path, design_shard_count(spec, shard), err);
    }
    spec_close(spec);
    return is_added;
}

static bool print_parts(const Parts *parts, bool is_wide, Err *err)
{
    Text text;
    text_init(&text);
    const Style style = output_style(stdout, is_wide);
    const bool is_written =
        study_text_status(parts->parts, parts->count, parts->places.data, &style, &text, err);
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
    bool is_reported = true;
    for (size_t i = 0; i < words->count && is_reported; i++) {
        Parts parts = {0};
        text_init(&parts.places);
        const char *word = words->words[i];
        is_reported =
            (study_path_is_study(word) ? add_study(&parts, word, err)
                                       : cmd_study_add_part(&parts, word, WANTED_UNKNOWN, err)) &&
            print_parts(&parts, words->is_wide, err);
        is_reported = finish_parts(&parts, err) && is_reported;
    }
    return is_reported;
}

static const Arguments STUDY_STATUS_ARGUMENTS = {
    .program = "jointplay study status",
    .usage = "FILE-or-STORE...",
    .doc = "Shows how far a study has come. For a study file, the stores of the usual names in "
           "the working folder or, without such, beside it are read. The study may be running "
           "meanwhile.",
    .argument = {.type = OPTION_READ, .read = study_words_read},
    OPTION_ROWS(STUDY_STATUS_OPTIONS),
};

static bool study_status_run(int argc, char **argv, Err *err)
{
    return study_words_run(&STUDY_STATUS_ARGUMENTS, argc, argv, tell, err);
}

const Command study_command_status = {
    .name = "status",
    .summary = "how far a study has come",
    .run = study_status_run,
    .arguments = &STUDY_STATUS_ARGUMENTS,
};

// study export: the store as a table for other programs.

typedef struct ExportOptions {
    const char *store;
    const char *csv;
    const char *jsonl;
    bool is_quiet;
} ExportOptions;

#define STUDY_EXPORT_AT(field) .offset = offsetof(ExportOptions, field)

static const OptionRow STUDY_EXPORT_OPTIONS[] = {
    {"csv", "FILE.csv", "Write one row per run there (default: to standard output)", 1, OPTION_TEXT,
     STUDY_EXPORT_AT(csv)},
    {"jsonl", "FILE.jsonl", "Write one object per run, each on its own line", 1, OPTION_TEXT,
     STUDY_EXPORT_AT(jsonl)},
    {"quiet", NULL, "Nothing on standard error but errors", 2, OPTION_FLAG,
     STUDY_EXPORT_AT(is_quiet), .letter = 'q'},
};

static bool study_export_check(void *options, Err *err)
{
    return ((const ExportOptions *)options)->store != NULL ||
           err_set(err, ERR_USAGE, "no store given: jointplay study export STORE.sqlite");
}

static bool cmd_study_write_all(void *target, Err *err)
{
    const ExportOptions *options = target;
    char path[FILE_PATH_SIZE];
    if (!study_path_find(options->store, path, err)) {
        return false;
    }
    Store *store = store_view(path, err);
    if (store == NULL) {
        return false;
    }
    const char *csv = options->csv == NULL && options->jsonl == NULL ? "-" : options->csv;
    const bool is_written =
        (csv == NULL || file_claim("--csv", FILE_TABLE, csv, err)) &&
        (options->jsonl == NULL || file_claim("--jsonl", FILE_ROWS, options->jsonl, err)) &&
        (csv == NULL ||
         (study_rows_write_csv(store, csv, err) && written_say(csv, options->is_quiet))) &&
        (options->jsonl == NULL || (study_rows_write_jsonl(store, options->jsonl, err) &&
                                    written_say(options->jsonl, options->is_quiet)));
    return store_close(store, err) && is_written;
}

static const Arguments STUDY_EXPORT_ARGUMENTS = {
    .program = "jointplay study export",
    .usage = "FILE-or-STORE",
    .doc = "Writes the rows of a store, one per run, in the order of their numbers."
           "\vA study file stands for its usual store in the working folder or beside it; - for "
           "standard output.",
    .argument = {.type = OPTION_TEXT, STUDY_EXPORT_AT(store), .what = "export takes one store"},
    OPTION_ROWS(STUDY_EXPORT_OPTIONS),
    .check = study_export_check,
};

static bool study_export_run(int argc, char **argv, Err *err)
{
    ExportOptions options = {0};
    return arguments_run(&STUDY_EXPORT_ARGUMENTS, argc, argv, &options, cmd_study_write_all, err);
}

const Command study_command_export = {
    .name = "export",
    .summary = "the rows of a store as CSV or JSON Lines",
    .run = study_export_run,
    .arguments = &STUDY_EXPORT_ARGUMENTS,
};

// study merge: the stores of shards become one.

static const OptionRow STUDY_MERGE_OPTIONS[] = {
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
                  "there is no %s beside the other parts; make it with --shard %" PRIu64 "/%" PRIu64
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
            Text places;
            text_init(&places);
            study_path_append_places(study, &places);
            err_set(err, ERR_FILE,
                    "there are no parts of %s %s, such as %s; 'jointplay study %s --shard 1/2' "
                    "makes one",
                    study, places.data, shard, path);
            text_finish(&places);
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

static const Arguments STUDY_MERGE_ARGUMENTS = {
    .program = "jointplay study merge",
    .usage = "FILE\nOUT.sqlite IN.sqlite...",
    .doc = "Merges the shards of a study into one store: those of a study file by their usual "
           "names in the working folder or beside it, or those that are named."
           "\vRuns that are there already are left alone. Stores of different studies or "
           "programs are refused, and nothing is written then.",
    .argument = {.type = OPTION_READ, .read = study_words_read},
    OPTION_ROWS(STUDY_MERGE_OPTIONS),
};

static bool study_merge_run(int argc, char **argv, Err *err)
{
    return study_words_run(&STUDY_MERGE_ARGUMENTS, argc, argv, merge_words, err);
}

const Command study_command_merge = {
    .name = "merge",
    .summary = "the shards of a study into one store",
    .run = study_merge_run,
    .arguments = &STUDY_MERGE_ARGUMENTS,
};

// study plot: one column over another.

typedef struct DrawOptions {
    const char *store;
    const char *file;
    StudyPlot plot;
    bool is_quiet;
} DrawOptions;

static bool cmd_study_read_word(const char *word, void *target, Err *err)
{
    DrawOptions *options = target;
    if (options->file != NULL) {
        return err_set(err, ERR_USAGE, "plot takes a store and a file, and '%s' is one more", word);
    }
    *(options->store == NULL ? &options->store : &options->file) = word;
    return true;
}

static bool read_title(const char *title, void *options, Err *err)
{
    ((DrawOptions *)options)->plot.title = title;
    return source_is_one_line(title, strlen(title)) ||
           err_set(err, ERR_USAGE, "--title: the argument is not text on one line");
}

#define STUDY_DRAW_AT(field) .offset = offsetof(DrawOptions, field)

static const OptionRow STUDY_DRAW_OPTIONS[] = {
    {"x", "COLUMN", "The column of the horizontal axis", 1, OPTION_TEXT, STUDY_DRAW_AT(plot.x)},
    {"y", "COLUMN", "The column of the vertical axis (default: how often each x occurs)", 1,
     OPTION_TEXT, STUDY_DRAW_AT(plot.y)},
    {"by", "COLUMN", "A colour for each value of this setting", 1, OPTION_TEXT,
     STUDY_DRAW_AT(plot.by)},
    {"title", "WORDS", "The title of the picture", 1, OPTION_READ, .read = read_title},
    {"quiet", NULL, "Nothing on standard error but errors", 2, OPTION_FLAG, STUDY_DRAW_AT(is_quiet),
     .letter = 'q'},
};

static bool study_draw_check(void *target, Err *err)
{
    const DrawOptions *options = target;
    if (options->file == NULL || options->plot.x == NULL) {
        return err_set(err, ERR_USAGE,
                       "%s: jointplay study plot STORE --x COLUMN --y COLUMN FILE.svg",
                       options->file == NULL ? "a store and a file are needed" : "no --x given");
    }
    return option_values_check_picture("plot", options->file, err);
}

static bool cmd_study_draw(void *target, Err *err)
{
    const DrawOptions *options = target;
    char path[FILE_PATH_SIZE];
    // a study file has the units that its user thinks in
    const bool is_study = study_path_is_study(options->store);
    Spec *spec = is_study ? spec_open(options->store, err) : NULL;
    Store *store = (spec != NULL || !is_study) && study_path_find(options->store, path, err)
                       ? store_view(path, err)
                       : NULL;
    if (store == NULL) {
        spec_close(spec);
        return false;
    }
    Text svg;
    text_init(&svg);
    bool is_drawn = file_claim("the picture", FILE_PICTURE, options->file, err) &&
                    study_plot_write(store, &options->plot, spec, &svg, err);
    is_drawn = store_close(store, err) && is_drawn &&
               written_text(FILE_PICTURE, options->file, svg.data, options->is_quiet, err);
    text_finish(&svg);
    spec_close(spec);
    return is_drawn;
}

static const Arguments STUDY_DRAW_ARGUMENTS = {
    .program = "jointplay study plot",
    .usage = "FILE-or-STORE FILE.svg",
    .doc = "Draws one column of a study over another, as SVG: one dot per run, or, if many "
           "runs share each x, their median and a band from 5 to 95 %."
           "\vThe first line of 'jointplay study export' names the columns. With a study file the "
           "axes have its units and scales, with a store SI.",
    .argument = {.type = OPTION_READ, .read = cmd_study_read_word},
    OPTION_ROWS(STUDY_DRAW_OPTIONS),
    .check = study_draw_check,
};

static bool study_draw_run(int argc, char **argv, Err *err)
{
    DrawOptions options = {0};
    return arguments_run(&STUDY_DRAW_ARGUMENTS, argc, argv, &options, cmd_study_draw, err);
}

const Command study_command_plot = {
    .name = "plot",
    .summary = "a picture of one column over another",
    .run = study_draw_run,
    .arguments = &STUDY_DRAW_ARGUMENTS,
};

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

#define CMD_STUDY_AT(field) .offset = offsetof(StudyOptions, field)

static const OptionRow CMD_STUDY_OPTIONS[] = {
    {"jobs", "N", "Runs at a time (default: one per core)", 1, OPTION_COUNT,
     CMD_STUDY_AT(common.jobs), .low = 1, .high = SWEEP_JOB_MAX},
    {"shard", "I/N", "Only the I-th of N parts, into a store of its own", 1, OPTION_READ,
     .read = read_shard},
    {"store", "FILE",
     "Keep the runs there (default: <study>.sqlite beside FILE if it is there, else here)", 1,
     OPTION_READ, .read = read_store},
    {"fresh", NULL, "Discard the contents of the store", 1, OPTION_FLAG, CMD_STUDY_AT(is_fresh)},
    COMMON_DRIVERS(1),
    {"retry-failed", NULL, "Repeat the runs that failed or whose rows are damaged", 1, OPTION_FLAG,
     CMD_STUDY_AT(is_retrying)},
    {"dry-run", NULL, "Print what would be run, and how long it would take, by a few runs", 2,
     OPTION_FLAG, CMD_STUDY_AT(is_dry)},
    COMMON_JSON(2),
    COMMON_FULL(2),
    COMMON_WIDE(2),
    COMMON_QUIET(2),
};

static bool cmd_study_check(void *target, Err *err)
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

static const Arguments STUDY_ARGUMENTS = {
    .program = "jointplay study",
    .usage = "FILE\nstatus FILE-or-STORE...\nexport FILE-or-STORE\nmerge FILE\n"
             "merge OUT.sqlite IN.sqlite...\nplot FILE-or-STORE FILE.svg\nslurm FILE",
    .doc = "Makes the runs of a study that its store does not hold yet, each in its own process, "
           "and keeps them in the store."
           "\vA study that is stopped at any moment resumes with the same command. 'jointplay "
           "study status --help' and so on explain the other words.",
    .argument = COMMON_PATH("study takes one file"),
    OPTION_ROWS(CMD_STUDY_OPTIONS),
    .check = cmd_study_check,
};

// The argument of such a command.
static bool study_words_read(const char *word, void *target, Err *err)
{
    (void)err;
    StudyWords *words = target;
    words->words[words->count++] = word;
    return true;
}

// Reads the command line and does the work with its words, unless help was all that was asked for.
// Fails as arguments_run does, or the work.
static bool study_words_run(const Arguments *arguments, int argc, char **argv,
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
                                       &study_command_merge,  &study_command_plot,
                                       &study_command_slurm,  NULL};
enum { PART_COUNT = sizeof PARTS / sizeof *PARTS - 1 };

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

static bool cmd_study_run(int argc, char **argv, Err *err)
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
    return arguments_run(&STUDY_ARGUMENTS, argc, argv, &options, study_run, err);
}

const Command cmd_study = {
    .name = "study",
    .summary = "sweeps values of a case into a store; resumes where it was stopped",
    .run = cmd_study_run,
    .arguments = &STUDY_ARGUMENTS,
    .parts = PARTS,
    .describe = spec_describe,
};

// study --dry-run: what a study would run.

enum {
    SHOWN_RUNS = 6,      // enough to see what changes fastest
    TRIED_RUNS = 200,    // over the whole study; a second's work
    STORE_BYTES = 30000, // of a store without rows
    NUMBER_BYTES = 8,    // of a real number in SQLite, besides a byte for its type
    ROW_BYTES = 70,      // of a row besides its cells: keys, hash, checksum, wall time, page ends
};

// The i-th of `count` runs spread over the whole shard.
static uint64_t cmd_study_spread(const StudyOptions *options, const Spec *spec, uint64_t i,
                                 uint64_t count)
{
    const double end = (double)design_run_count(spec);
    const uint64_t from = (uint64_t)floor((double)i * end / (double)count);
    return design_next(spec, options->shard, from);
}

static void cmd_study_append_cell(Table *table, const Column *column, const Cell *cell)
{
    if (column->kind == COLUMN_WORD) {
        table_cell(table, "%s", cell->word);
    } else {
        table_cell(table, "%.5g", cell->number);
    }
}

static void append_runs(const StudyOptions *options, const Spec *spec, const Layout *layout,
                        size_t width, Text *text)
{
    Table *table = table_create(layout->setting_count + 1);
    table_fit(table, width);
    table_head(table, 0, "run", "", TABLE_RIGHT);
    for (size_t i = 0; i < layout->setting_count; i++) {
        const bool is_word = layout->settings[i].kind == COLUMN_WORD;
        table_head(table, i + 1, layout->settings[i].name, "", is_word ? TABLE_LEFT : TABLE_RIGHT);
    }
    const uint64_t end = design_run_count(spec);
    uint64_t run = design_next(spec, options->shard, 0);
    for (int shown = 0; shown < SHOWN_RUNS && run < end; shown++) {
        Cell values[RECORD_SETTING_MAX];
        design_values(spec, run, values);
        table_cell(table, "%" PRIu64, run);
        for (size_t i = 0; i < layout->setting_count; i++) {
            cmd_study_append_cell(table, &layout->settings[i], &values[i]);
        }
        run = design_next(spec, options->shard, run + 1);
    }
    table_write(table, text);
    table_destroy(table);
}

// Tries whether values over the whole study make valid cases.
static void append_trials(const StudyOptions *options, const Spec *spec, Text *text)
{
    const uint64_t end = design_run_count(spec);
    const uint64_t count = end < TRIED_RUNS ? end : TRIED_RUNS;
    uint64_t tried = 0;
    uint64_t refused = 0;
    uint64_t first = 0;
    Err reason = {0};
    for (uint64_t i = 0; i < count; i++) {
        Cell values[RECORD_SETTING_MAX];
        BackendKind backend;
        Err err = {0};
        const uint64_t run = cmd_study_spread(options, spec, i, count);
        if (run >= end) {
            break;
        }
        tried++;
        design_values(spec, run, values);
        Scenario scenario = {.point_count = 0};
        if (!design_scenario(spec, values, &scenario, &backend, &err)) {
            reason = refused == 0 ? err : reason;
            first = refused++ == 0 ? run : first;
        }
        scenario_free(&scenario);
    }
    text_append(text, "Runs tried over all of it: %" PRIu64 "; of them no valid case: %" PRIu64,
                tried, refused);
    text_append(text, refused > 0 ? "; the first is run %" PRIu64 ": %s\n" : ".\n", first,
                reason.text);
}

// A setting that is a word or a few digits takes less than a number with all of its own.
static double store_bytes(const Layout *layout, uint64_t runs)
{
    const double cells = (double)(layout->setting_count + layout->result_count);
    return STORE_BYTES + (double)runs * (ROW_BYTES + cells * (NUMBER_BYTES + 1));
}

// How long it would take, by runs that are made for it.
static void append_time(const StudyOptions *options, const Spec *spec, const Layout *layout,
                        uint64_t runs, Text *text)
{
    const StudyPace pace = study_run_pace(options, spec, layout);
    if (pace.made == 0) {
        text_append(text, "How long it would take is not known: no run was over in %.0f s.\n",
                    pace.wall_s);
        return;
    }
    text_append(text, "It would take some ");
    status_line_append_time(text, (double)runs * pace.wall_s / (double)pace.made);
    text_append(text, " with %zu at a time, by the first %" PRIu64 ", which took ",
                options->common.jobs, pace.made);
    units_append(text, pace.wall_s, "s");
    text_append(text, ".\n");
}

// What makes the runs of a study that does not say so by a scheme.
static void append_maker(const Spec *spec, Text *text)
{
    if (spec->backend == BACKEND_REFERENCE) {
        text_append(text,
                    "The reference makes the runs%s, and no other solver: neither the case "
                    "nor the study names a scheme, a step or a setting of ODE, or truth: "
                    "true.\n",
                    spec->is_quick ? ", to a tolerance of 1e-8" : "");
    }
    if (spec->has_neighbours) {
        text_append(text,
                    "Of twenty settled runs in a row two find their motion by themselves, the "
                    "others begin in a neighbour's; settle: each lets all find their own.\n");
    }
}

bool study_run_dry(const StudyOptions *options, const Spec *spec, const Layout *layout, Err *err)
{
    (void)err;
    const Style style = output_style(stdout, options->common.is_wide);
    const uint64_t end = design_run_count(spec);
    const uint64_t runs = design_shard_count(spec, options->shard);
    Text text;
    text_init(&text);
    text_append(&text, "%s%s%s\n\n", style.heading, spec->title, style.end);
    text_append(&text, "Case ");
    text_append_shown(&text, spec->case_path);
    text_append(&text, ", %zu variables, %" PRIu64 " runs", spec->variable_count, end);
    if (options->shard.count > 1) {
        text_append(&text, ", %" PRIu64 " of them in part %" PRIu64 " of %" PRIu64, runs,
                    options->shard.index + 1, options->shard.count);
    }
    if (spec->has_truth) {
        text_append(&text, ", %" PRIu64 " truths", design_group(spec, end - 1) + 1);
    }
    text_append(&text, ".\n");
    append_maker(spec, &text);
    text_append(&text, "The store ");
    text_append_shown(&text, options->store);
    text_append(&text, " would take some %.2g MB.\n", 1e-6 * store_bytes(layout, runs));
    append_trials(options, spec, &text);
    append_time(options, spec, layout, runs, &text);
    text_append(&text, "\n%sFirst runs%s\n", style.heading, style.end);
    append_runs(options, spec, layout, style.width, &text);
    output_text(&text, &style);
    text_finish(&text);
    return true;
}

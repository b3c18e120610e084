// What is in the store of a study, as a table for other programs?
#include "cli/arguments.h"
#include "cli/written.h"
#include "commands/study/study_commands.h"
#include "commands/study/study_csv.h"
#include "commands/study/study_jsonl.h"
#include "commands/study/study_place.h"

#include <string.h>

enum { KEY_CSV = 0x200, KEY_JSONL, KEY_QUIET = 'q' };

typedef struct ExportOptions {
    const char *store;
    const char *csv;
    const char *jsonl;
    bool is_quiet;
} ExportOptions;

static const struct argp_option OPTIONS[] = {
    {"csv", KEY_CSV, "FILE.csv", 0, "Write a row a run there (default: to standard output)", 1},
    {"jsonl", KEY_JSONL, "FILE.jsonl", 0, "Write an object a run, each on a line of its own", 1},
    {"quiet", KEY_QUIET, NULL, 0, "Nothing on standard error but errors", 2},
    {0},
};

static bool take_option(int key, const char *value, void *target, Err *err)
{
    ExportOptions *options = target;
    switch (key) {
    case KEY_CSV:
        options->csv = value;
        return true;
    case KEY_JSONL:
        options->jsonl = value;
        return true;
    case KEY_QUIET:
        options->is_quiet = true;
        return true;
    default:
        if (options->store != NULL) {
            return err_set(err, ERR_USAGE, "export takes one store, not %s and %s", options->store,
                           value);
        }
        options->store = value;
        return true;
    }
}

static bool say(const char *path, bool is_quiet)
{
    return file_is_stream(path) || written_say(path, is_quiet);
}

static bool write_all(const ExportOptions *options, Err *err)
{
    char path[FILE_PATH_SIZE];
    if (!study_place_find(options->store, path, err)) {
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
        (csv == NULL || (study_csv_write(store, csv, err) && say(csv, options->is_quiet))) &&
        (options->jsonl == NULL ||
         (study_jsonl_write(store, options->jsonl, err) && say(options->jsonl, options->is_quiet)));
    return store_close(store, err) && is_written;
}

static bool run(int argc, char **argv, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay study export",
        .usage = "FILE-or-STORE",
        .doc = "Writes the rows of a store, a run each, by rising number of run."
               "\vA study file stands for its usual store in the working folder; - for standard "
               "output.",
        .options = OPTIONS,
        .take = take_option,
    };
    ExportOptions options = {0};
    bool is_answered;
    if (!arguments_parse(&ARGUMENTS, argc, argv, &options, &is_answered, err) || is_answered) {
        return err->kind == ERR_NONE;
    }
    if (options.store == NULL) {
        return err_set(err, ERR_USAGE, "no store given: jointplay study export STORE.sqlite");
    }
    return write_all(&options, err);
}

const Command study_command_export = {
    .name = "export",
    .summary = "the rows of a store as CSV or JSON Lines",
    .run = run,
};

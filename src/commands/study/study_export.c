// What is in the store of a study, as a table for other programs?
#include "cli/arguments.h"
#include "cli/written.h"
#include "commands/study/study_commands.h"
#include "commands/study/study_path.h"
#include "commands/study/study_rows.h"

#include <string.h>

typedef struct ExportOptions {
    const char *store;
    const char *csv;
    const char *jsonl;
    bool is_quiet;
} ExportOptions;

#define AT(field) .offset = offsetof(ExportOptions, field)

static const OptionRow OPTIONS[] = {
    {"csv", "FILE.csv", "Write one row per run there (default: to standard output)", 1, OPTION_TEXT,
     AT(csv)},
    {"jsonl", "FILE.jsonl", "Write one object per run, each on its own line", 1, OPTION_TEXT,
     AT(jsonl)},
    {"quiet", NULL, "Nothing on standard error but errors", 2, OPTION_FLAG, AT(is_quiet),
     .letter = 'q'},
};

static bool check(void *options, Err *err)
{
    return ((const ExportOptions *)options)->store != NULL ||
           err_set(err, ERR_USAGE, "no store given: jointplay study export STORE.sqlite");
}

static bool write_all(void *target, Err *err)
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

static bool run(int argc, char **argv, Err *err)
{
    static const Arguments ARGUMENTS = {
        .program = "jointplay study export",
        .usage = "FILE-or-STORE",
        .doc = "Writes the rows of a store, one per run, in the order of their numbers."
               "\vA study file stands for its usual store in the working folder; - for standard "
               "output.",
        .argument = {.type = OPTION_TEXT, AT(store), .what = "export takes one store"},
        OPTION_ROWS(OPTIONS),
        .check = check,
    };
    ExportOptions options = {0};
    return arguments_run(&ARGUMENTS, argc, argv, &options, write_all, err);
}

const Command study_command_export = {
    .name = "export",
    .summary = "the rows of a store as CSV or JSON Lines",
    .run = run,
};

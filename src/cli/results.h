// What a command has to say, in every form: printed as text or as JSON, and in the files that its
// options name or that go into the folder of --out.
#pragma once

#include "cli/common_options.h"
#include "write/file.h"
#include "write/json_value.h"
#include "write/table.h"

// One file. What it holds comes from one of the three functions; a report and a result without any
// are the text and the JSON that are printed otherwise.
typedef struct ResultFile {
    const char *option; // that names it, "--csv"; NULL: it goes into the folder alone
    size_t offset;      // of its path in the command's options
    const char *ending; // of its name in the folder, ".csv"; NULL: it does not go there
    FileKind kind;
    void (*text)(const void *report, Text *text);
    // Writes all of the file itself. ERR_FILE.
    bool (*write)(const void *report, const char *path, Err *err);
    // As `text`, but false where there is nothing to write, with the reason in `nothing`, or where
    // the error is set.
    bool (*may)(const void *report, Text *text, const char **nothing, Err *err);
} ResultFile;

typedef struct Results {
    const char *suffix; // of the names in the folder, behind the case's: "-compare"
    bool is_followed;   // by an empty line, where the text is printed
    json_t *(*json)(const void *report);
    void (*text)(const void *report, const Style *style, Text *text);
    // What is printed without --full: the answer alone; NULL: the whole text is.
    void (*screen)(const void *report, const Style *style, Text *text);
    const ResultFile *files; // in the order in which they are written
    size_t file_count;
} Results;

// A table of files, in the initializer of Results.
#define RESULT_FILES(rows) .files = (rows), .file_count = sizeof(rows) / sizeof *(rows)

// Prints what the text of a report begins with, before the rest of it is known, where it is printed
// as text, and appends it to `begun`.
typedef void ResultsText(const void *report, const Style *style, Text *text);
void results_print_begin(const CommonOptions *options, ResultsText *write, const void *report,
                         Text *begun);

// Prints the report as results_print does, but for what was printed already, if it begins with it.
void results_print_rest(const Results *results, const CommonOptions *options, const void *report,
                        const Text *begun);

// Prints the report, as text or as JSON. `options` here and below are those of the command, which
// begin with CommonOptions.
void results_print(const Results *results, const CommonOptions *options, const void *report);

// Whether anybody reads more of the results than the first screen.
bool results_tell_all(const Results *results, const CommonOptions *options);

// Whether all files can be written, before the work whose results they are to hold: makes the
// folder and claims every file. Names in the folder begin with that of the case. Fails as
// file_claim does.
bool results_claim(const Results *results, const CommonOptions *options, const char *case_path,
                   Err *err);

// Writes all files, and says so unless quiet. ERR_FILE, what `may` says, and ERR_DIFFERS where
// there is nothing to write into a file that an option names: the others are written all the same.
// A file of the folder that has no contents is named in a warning.
bool results_write(const Results *results, const CommonOptions *options, const char *case_path,
                   const void *report, Err *err);

// The path of a file in the folder of --out. ERR_FILE where it is too long.
bool results_path(const CommonOptions *options, const char *name, const char *ending, char *path,
                  Err *err);

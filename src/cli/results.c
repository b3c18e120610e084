// Prints and writes the results of a command.
//
// Every file is claimed before the work, so that one that cannot be written fails at once.
#include "cli/results.h"

#include "cli/output.h"
#include "cli/written.h"
#include "write/file.h"

#include <stdio.h>
#include <string.h>

enum { ENDING_SIZE = 32 }; // "-compare.json"

// Prints words, which are folded as the screen is wide.
static void print_folded(const char *words, const Style *style)
{
    Text shown;
    text_init(&shown);
    text_append(&shown, "%s", words);
    output_text(&shown, style);
    text_finish(&shown);
}

void results_print_begin(const CommonOptions *options, ResultsText *write, const void *report,
                         Text *begun)
{
    if (options->is_json) {
        return;
    }
    const Style style = output_style(stdout, options->is_wide);
    write(report, &style, begun);
    print_folded(begun->data, &style);
    fflush(stdout);
}

static bool is_whole(const Results *results, const CommonOptions *options)
{
    return results->screen == NULL || options->is_full || options->is_wide;
}

bool results_tell_all(const Results *results, const CommonOptions *options)
{
    return options->is_json || options->folder != NULL || is_whole(results, options);
}

void results_print_rest(const Results *results, const CommonOptions *options, const void *report,
                        const Text *begun)
{
    if (options->is_json) {
        output_json(results->json(report));
        return;
    }
    Text text;
    text_init(&text);
    const Style style = output_style(stdout, options->is_wide);
    (is_whole(results, options) ? results->text : results->screen)(report, &style, &text);
    text_append(&text, "%s", results->is_followed ? "\n" : "");
    const bool is_begun = begun->length > 0 && strncmp(text.data, begun->data, begun->length) == 0;
    print_folded(text.data + (is_begun ? begun->length : 0), &style);
    text_finish(&text);
}

void results_print(const Results *results, const CommonOptions *options, const void *report)
{
    Text begun;
    text_init(&begun);
    results_print_rest(results, options, report, &begun);
    text_finish(&begun);
}

bool results_path(const CommonOptions *options, const char *name, const char *ending, char *path,
                  Err *err)
{
    const int length = snprintf(path, FILE_PATH_SIZE, "%s/%s%s", options->folder, name, ending);
    return (length >= 0 && length < FILE_PATH_SIZE) ||
           err_set(err, ERR_FILE, "the path of %s%s is too long", name, ending);
}

// The path of a file in the folder, by its row.
static bool find_path(const Results *results, const CommonOptions *options, const char *case_path,
                      const ResultFile *file, char path[FILE_PATH_SIZE], Err *err)
{
    char name[SCENARIO_PATH_SIZE];
    char ending[ENDING_SIZE];
    file_stem(case_path, name, sizeof name);
    snprintf(ending, sizeof ending, "%s%s", results->suffix, file->ending);
    return results_path(options, name, ending, path, err);
}

// The path that an option gives, or NULL.
static const char *path_of(const ResultFile *file, const CommonOptions *options)
{
    return file->option == NULL
               ? NULL
               : *(const char *const *)(const void *)((const char *)options + file->offset);
}

bool results_claim(const Results *results, const CommonOptions *options, const char *case_path,
                   Err *err)
{
    for (size_t i = 0; i < results->file_count; i++) {
        const ResultFile *file = &results->files[i];
        const char *path = path_of(file, options);
        if (path != NULL && !file_claim(file->option, file->kind, path, err)) {
            return false;
        }
    }
    if (options->folder == NULL) {
        return true;
    }
    if (!file_make_folder(options->folder, err)) {
        return false;
    }
    for (size_t i = 0; i < results->file_count; i++) {
        const ResultFile *file = &results->files[i];
        char path[FILE_PATH_SIZE];
        if (file->ending != NULL && !(find_path(results, options, case_path, file, path, err) &&
                                      file_claim("--out", file->kind, path, err))) {
            return false;
        }
    }
    return true;
}

// What a file holds; false where that is nothing.
static bool fill(const Results *results, const ResultFile *file, const void *report, Text *text,
                 const char **nothing, Err *err)
{
    if (file->may != NULL) {
        return file->may(report, text, nothing, err);
    }
    if (file->text != NULL) {
        file->text(report, text);
    } else if (file->kind == FILE_RESULT) {
        json_t *object = results->json(report);
        json_value_write(object, JSON_VALUE_FLAGS, text);
        text_append(text, "\n");
        json_decref(object);
    } else {
        results->text(report, &STYLE_PLAIN, text);
        output_fold(text, &STYLE_PLAIN);
    }
    return true;
}

// Writes one file. Where there is nothing to write: of a file that an option names an error, of one
// that the folder would have had with others a warning, which quiet does not silence.
static bool write_file(const Results *results, const ResultFile *file, const char *path,
                       const CommonOptions *options, bool is_named, const void *report, Err *err)
{
    if (file->write != NULL) {
        return file->write(report, path, err) && written_say(path, options->is_quiet);
    }
    Text text;
    text_init(&text);
    const char *nothing = "";
    const bool is_filled = fill(results, file, report, &text, &nothing, err);
    bool is_done = is_filled ? written_text(file->kind, path, text.data, options->is_quiet, err)
                             : err->kind == ERR_NONE;
    if (!is_filled && is_done && is_named) {
        is_done = err_set(err, ERR_DIFFERS, "not written: %s %s (%s)", file->option, path, nothing);
    } else if (!is_filled && is_done) {
        output_say("jointplay: warning: not written: %s (%s)\n", path, nothing);
    }
    text_finish(&text);
    return is_done;
}

// Says every error and goes on: what is missing of one file does not take the others away.
bool results_write(const Results *results, const CommonOptions *options, const char *case_path,
                   const void *report, Err *err)
{
    bool is_done = true;
    for (size_t i = 0; i < results->file_count && err->kind != ERR_FILE; i++) {
        const char *path = path_of(&results->files[i], options);
        Err own = {0};
        if (path != NULL &&
            !write_file(results, &results->files[i], path, options, true, report, &own)) {
            is_done = err_add(err, &own);
        }
    }
    for (size_t i = 0; options->folder != NULL && i < results->file_count; i++) {
        const ResultFile *file = &results->files[i];
        char path[FILE_PATH_SIZE];
        Err own = {0};
        if (file->ending != NULL &&
            !(find_path(results, options, case_path, file, path, &own) &&
              write_file(results, file, path, options, false, report, &own))) {
            is_done = err_add(err, &own);
        }
    }
    return is_done;
}

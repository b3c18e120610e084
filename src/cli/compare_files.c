// Which files does a comparison leave behind?
#include "cli/compare_files.h"

#include "cli/case_run.h"
#include "cli/run_files.h"
#include "report/compare_csv.h"
#include "report/compare_json.h"
#include "report/compare_plot.h"
#include "report/compare_text.h"
#include "report/file.h"
#include "report/run_json.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

static bool say_written(const char *path, bool is_quiet)
{
    if (!is_quiet) {
        fprintf(stderr, "wrote %s\n", path);
    }
    return true;
}

static bool write_csv(const CompareReport *report, const char *path, bool is_quiet, Err *err)
{
    return compare_csv_write(report, path, err) && say_written(path, is_quiet);
}

static bool write_text(const char *path, Text *text, bool is_quiet, Err *err)
{
    const bool is_written = file_write_text(path, text->data, err) && say_written(path, is_quiet);
    text_finish(text);
    return is_written;
}

static bool write_plot(const CompareReport *report, const char *path, bool is_quiet, Err *err)
{
    Text svg;
    text_init(&svg);
    compare_plot_write(report, &svg);
    return write_text(path, &svg, is_quiet, err);
}

static bool write_report(const CompareReport *report, const char *path, bool is_quiet, Err *err)
{
    Text text;
    text_init(&text);
    compare_text_write(report, &STYLE_PLAIN, &text);
    return write_text(path, &text, is_quiet, err);
}

static bool write_json(const CompareReport *report, const char *path, bool is_quiet, Err *err)
{
    json_t *object = compare_json_build(report);
    char *words = json_dumps(object, RUN_JSON_FLAGS);
    assert(words != NULL);
    Text text;
    text_init(&text);
    text_append(&text, "%s\n", words);
    free(words);
    json_decref(object);
    return write_text(path, &text, is_quiet, err);
}

static bool write_folder(const CompareReport *report, const CompareOptions *options, Err *err)
{
    static bool (*const WRITERS[])(const CompareReport *, const char *, bool,
                                   Err *) = {write_report, write_csv, write_plot, write_json};
    static const char *const ENDINGS[] = {"txt", "csv", "svg", "json"};
    char name[SCENARIO_PATH_SIZE];
    char path[FILE_PATH_SIZE];
    case_run_name(report->scenario, name, sizeof name);
    for (int i = 0; i < 4; i++) {
        const int length =
            snprintf(path, sizeof path, "%s/%s-compare.%s", options->folder, name, ENDINGS[i]);
        if (length < 0 || length >= FILE_PATH_SIZE) {
            return err_set(err, ERR_FILE, "the path of %s-compare.%s is too long", name,
                           ENDINGS[i]);
        }
        if (!WRITERS[i](report, path, options->is_quiet, err)) {
            return false;
        }
    }
    return true;
}

bool compare_files_write(const CompareReport *report, const CompareOptions *options, Err *err)
{
    const bool is_quiet = options->is_quiet;
    return (options->csv == NULL || write_csv(report, options->csv, is_quiet, err)) &&
           (options->plot == NULL || write_plot(report, options->plot, is_quiet, err)) &&
           (options->folder == NULL || write_folder(report, options, err));
}

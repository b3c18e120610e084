// Which files does a comparison leave behind?
#include "commands/compare/compare_files.h"

#include "cli/output.h"
#include "cli/written.h"
#include "commands/compare/compare_csv.h"
#include "commands/compare/compare_json.h"
#include "commands/compare/compare_plot.h"
#include "commands/compare/compare_text.h"
#include "write/file.h"

#include <stdio.h>

enum { MEMBER_COUNT = 4 };

static const struct {
    const char *ending;
    FileKind kind;
} MEMBERS[MEMBER_COUNT] = {
    {"txt", FILE_REPORT}, {"csv", FILE_TABLE}, {"svg", FILE_PICTURE}, {"json", FILE_RESULT}};

static bool write_csv(const CompareReport *report, const char *path, bool is_quiet, Err *err)
{
    return compare_csv_write(report, path, err) && written_say(path, is_quiet);
}

static bool write_text(FileKind kind, const char *path, Text *text, bool is_quiet, Err *err)
{
    const bool is_written = written_text(kind, path, text->data, is_quiet, err);
    text_finish(text);
    return is_written;
}

static bool write_plot(const CompareReport *report, const char *path, bool is_quiet, Err *err)
{
    Text svg;
    text_init(&svg);
    compare_plot_write(report, &svg);
    return write_text(FILE_PICTURE, path, &svg, is_quiet, err);
}

static bool write_report(const CompareReport *report, const char *path, bool is_quiet, Err *err)
{
    Text text;
    text_init(&text);
    compare_text_write(report, &STYLE_PLAIN, &text);
    output_fold(&text, &STYLE_PLAIN);
    return write_text(FILE_REPORT, path, &text, is_quiet, err);
}

static bool write_json(const CompareReport *report, const char *path, bool is_quiet, Err *err)
{
    json_t *object = compare_json_build(report);
    const bool is_written = written_json(path, object, is_quiet, err);
    json_decref(object);
    return is_written;
}

// The file of that ending in the folder.
static bool find_path(const CompareOptions *options, const Scenario *scenario, const char *ending,
                      char path[FILE_PATH_SIZE], Err *err)
{
    char name[SCENARIO_PATH_SIZE];
    file_stem(scenario->path, name, sizeof name);
    const int length =
        snprintf(path, FILE_PATH_SIZE, "%s/%s-compare.%s", options->common.folder, name, ending);
    return (length >= 0 && length < FILE_PATH_SIZE) ||
           err_set(err, ERR_FILE, "the path of %s-compare.%s is too long", name, ending);
}

static bool write_folder(const CompareReport *report, const CompareOptions *options, Err *err)
{
    static bool (*const WRITERS[MEMBER_COUNT])(const CompareReport *, const char *, bool, Err *) = {
        write_report, write_csv, write_plot, write_json};
    char path[FILE_PATH_SIZE];
    for (int i = 0; i < MEMBER_COUNT; i++) {
        if (!find_path(options, report->scenario, MEMBERS[i].ending, path, err) ||
            !WRITERS[i](report, path, options->common.is_quiet, err)) {
            return false;
        }
    }
    return true;
}

bool compare_files_claim(const Scenario *scenario, const CompareOptions *options, Err *err)
{
    if ((options->csv != NULL && !file_claim("--csv", FILE_TABLE, options->csv, err)) ||
        (options->plot != NULL && !file_claim("--plot", FILE_PICTURE, options->plot, err))) {
        return false;
    }
    for (int i = 0; options->common.folder != NULL && i < MEMBER_COUNT; i++) {
        char path[FILE_PATH_SIZE];
        if (!find_path(options, scenario, MEMBERS[i].ending, path, err) ||
            !file_claim("--out", MEMBERS[i].kind, path, err)) {
            return false;
        }
    }
    return true;
}

bool compare_files_write(const CompareReport *report, const CompareOptions *options, Err *err)
{
    const bool is_quiet = options->common.is_quiet;
    return (options->csv == NULL || write_csv(report, options->csv, is_quiet, err)) &&
           (options->plot == NULL || write_plot(report, options->plot, is_quiet, err)) &&
           (options->common.folder == NULL || write_folder(report, options, err));
}

// Which files does a mapping leave behind?
#include "commands/map/map_files.h"

#include "cli/output.h"
#include "cli/written.h"
#include "commands/map/mapping_csv.h"
#include "commands/map/mapping_json.h"
#include "commands/map/mapping_plot.h"
#include "commands/map/mapping_text.h"
#include "write/file.h"

#include <stdio.h>

static bool write_csv(const MappingReport *report, const char *path, bool is_quiet, Err *err)
{
    return mapping_csv_write(report, path, err) && written_say(path, is_quiet);
}

static bool write_text(FileKind kind, const char *path, Text *text, bool is_quiet, Err *err)
{
    const bool is_written = written_text(kind, path, text->data, is_quiet, err);
    text_finish(text);
    return is_written;
}

static bool write_plot(const MappingReport *report, const char *path, bool is_quiet, Err *err)
{
    Text svg;
    text_init(&svg);
    mapping_plot_write(report, &svg);
    return write_text(FILE_PICTURE, path, &svg, is_quiet, err);
}

static bool write_report(const MappingReport *report, const char *path, bool is_quiet, Err *err)
{
    Text text;
    text_init(&text);
    mapping_text_write(report, &STYLE_PLAIN, &text);
    output_fold(&text, &STYLE_PLAIN);
    return write_text(FILE_REPORT, path, &text, is_quiet, err);
}

static bool write_json(const MappingReport *report, const char *path, bool is_quiet, Err *err)
{
    json_t *object = mapping_json_build(report);
    const bool is_written = written_json(path, object, is_quiet, err);
    json_decref(object);
    return is_written;
}

// What goes into the folder, by its ending.
static const struct {
    const char *ending;
    FileKind kind;
    bool (*write)(const MappingReport *report, const char *path, bool is_quiet, Err *err);
} MEMBERS[] = {
    {"txt", FILE_REPORT, write_report},
    {"csv", FILE_TABLE, write_csv},
    {"svg", FILE_PICTURE, write_plot},
    {"json", FILE_RESULT, write_json},
};

enum { MEMBER_COUNT = sizeof MEMBERS / sizeof *MEMBERS };

// The file of that ending in the folder.
static bool find_path(const MapOptions *options, const Scenario *scenario, const char *ending,
                      char path[FILE_PATH_SIZE], Err *err)
{
    char name[SCENARIO_PATH_SIZE];
    file_stem(scenario->path, name, sizeof name);
    if (name[0] == '\0') {
        snprintf(name, sizeof name, "lone-contact");
    }
    const int length =
        snprintf(path, FILE_PATH_SIZE, "%s/%s-map.%s", options->common.folder, name, ending);
    return (length >= 0 && length < FILE_PATH_SIZE) ||
           err_set(err, ERR_FILE, "the path of %s-map.%s is too long", name, ending);
}

bool map_files_claim(const Scenario *scenario, const MapOptions *options, Err *err)
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

bool map_files_write(const MappingReport *report, const MapOptions *options, Err *err)
{
    const bool is_quiet = options->common.is_quiet;
    if ((options->csv != NULL && !write_csv(report, options->csv, is_quiet, err)) ||
        (options->plot != NULL && !write_plot(report, options->plot, is_quiet, err))) {
        return false;
    }
    for (int i = 0; options->common.folder != NULL && i < MEMBER_COUNT; i++) {
        char path[FILE_PATH_SIZE];
        if (!find_path(options, report->scenario, MEMBERS[i].ending, path, err) ||
            !MEMBERS[i].write(report, path, is_quiet, err)) {
            return false;
        }
    }
    return true;
}

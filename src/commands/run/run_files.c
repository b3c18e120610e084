// Which files does a run leave behind, and what are they called?
#include "commands/run/run_files.h"

#include "cli/output.h"
#include "cli/written.h"
#include "commands/run/plot_run.h"
#include "commands/run/run_json.h"
#include "commands/run/run_text.h"
#include "commands/run/series_csv.h"
#include "write/file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool write_series(const CaseRun *run, const Trajectory *trajectory, const char *path,
                         bool is_quiet, Err *err)
{
    return series_csv_write(&run->scenario, trajectory, path, err) && written_say(path, is_quiet);
}

bool run_files_plot(const CaseRun *run, const char *path, bool is_quiet, Err *err)
{
    Text svg;
    text_init(&svg);
    plot_run_write(&run->report, &svg);
    const bool is_written = written_text(FILE_PICTURE, path, svg.data, is_quiet, err);
    text_finish(&svg);
    return is_written;
}

// The file that a run's series goes to.
static void find_series(const CaseRun *run, const char *path, size_t number, char *target)
{
    const RunOptions *options = &run->scenario.run;
    // a stream takes all series as it is; a name is only made for files
    const size_t file_count = file_is_stream(path) ? 1 : options->backend_count;
    series_csv_path(path, OPTIONS_BACKENDS[options->backends[number]], file_count, target,
                    FILE_PATH_SIZE);
}

bool run_files_series(const CaseRun *run, const char *path, bool is_quiet, Err *err)
{
    for (size_t i = 0; i < run->report.run_count; i++) {
        const Trajectory *trajectory = run->runs[i];
        char target[FILE_PATH_SIZE];
        find_series(run, path, i, target);
        if (trajectory->is_complete && !write_series(run, trajectory, target, is_quiet, err)) {
            return false;
        }
    }
    return true;
}

bool run_files_claim(const CaseRun *run, const char *series, const char *plot, Err *err)
{
    // a stream takes all of them
    const bool is_stream = series != NULL && file_is_stream(series);
    const size_t count = is_stream ? 1 : run->scenario.run.backend_count;
    if (series != NULL && !file_check_input("--series", series, err)) {
        return false;
    }
    for (size_t i = 0; series != NULL && i < count; i++) {
        char target[FILE_PATH_SIZE];
        find_series(run, series, i, target);
        if (!file_claim("--series", FILE_TABLE, target, err)) {
            return false;
        }
    }
    return plot == NULL || file_claim("--plot", FILE_PICTURE, plot, err);
}

// FOLDER/NAME, then what tells the files of one case apart.
static bool join_path(const char *folder, const char *name, const char *ending, char *path,
                      Err *err)
{
    const int written = snprintf(path, FILE_PATH_SIZE, "%s/%s%s", folder, name, ending);
    if (written < 0 || written >= FILE_PATH_SIZE) {
        return err_set(err, ERR_FILE, "the path of %s%s is too long", name, ending);
    }
    return true;
}

static bool write_json(const CaseRun *run, const char *path, bool is_quiet, Err *err)
{
    json_t *object = run_json_build(&run->report);
    const bool is_written = written_json(path, object, is_quiet, err);
    json_decref(object);
    return is_written;
}

static bool write_report(const CaseRun *run, const char *path, bool is_quiet, Err *err)
{
    Text text;
    text_init(&text);
    run_text_write(&run->report, &STYLE_PLAIN, &text);
    output_fold(&text, &STYLE_PLAIN);
    const bool is_written = written_text(FILE_REPORT, path, text.data, is_quiet, err);
    text_finish(&text);
    return is_written;
}

// The file of a backend's series in the folder.
static bool find_member(const CaseRun *run, const char *folder, size_t number, char *path, Err *err)
{
    char name[FILE_PATH_SIZE];
    char ending[LINKAGE_NAME_SIZE + 8];
    const RunOptions *options = &run->scenario.run;
    file_stem(run->scenario.path, name, sizeof name);
    snprintf(ending, sizeof ending, "-%s.csv", OPTIONS_BACKENDS[options->backends[number]]);
    return join_path(folder, name, ending, path, err);
}

bool run_files_claim_folder(const CaseRun *run, const char *folder, Err *err)
{
    static const struct {
        const char *ending;
        FileKind kind;
    } MEMBERS[] = {{".svg", FILE_PICTURE}, {".txt", FILE_REPORT}, {".json", FILE_RESULT}};
    char name[FILE_PATH_SIZE];
    char path[FILE_PATH_SIZE];
    file_stem(run->scenario.path, name, sizeof name);
    for (size_t i = 0; i < sizeof MEMBERS / sizeof *MEMBERS; i++) {
        if (!join_path(folder, name, MEMBERS[i].ending, path, err) ||
            !file_claim("--out", MEMBERS[i].kind, path, err)) {
            return false;
        }
    }
    for (size_t i = 0; i < run->scenario.run.backend_count; i++) {
        if (!find_member(run, folder, i, path, err) ||
            !file_claim("--out", FILE_TABLE, path, err)) {
            return false;
        }
    }
    return true;
}

bool run_files_folder(const CaseRun *run, const char *folder, bool is_quiet, Err *err)
{
    char name[FILE_PATH_SIZE];
    char path[FILE_PATH_SIZE];
    file_stem(run->scenario.path, name, sizeof name);
    for (size_t i = 0; i < run->report.run_count; i++) {
        const Trajectory *trajectory = run->runs[i];
        if (!find_member(run, folder, i, path, err)) {
            return false;
        }
        if (!trajectory->is_complete) {
            // a series of an earlier run must not stand for one that failed
            file_remove(FILE_TABLE, path);
        } else if (!write_series(run, trajectory, path, is_quiet, err)) {
            return false;
        }
    }
    return join_path(folder, name, ".svg", path, err) && run_files_plot(run, path, is_quiet, err) &&
           join_path(folder, name, ".txt", path, err) && write_report(run, path, is_quiet, err) &&
           join_path(folder, name, ".json", path, err) && write_json(run, path, is_quiet, err);
}

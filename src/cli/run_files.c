// Which files does a run leave behind, and what are they called?
#include "cli/run_files.h"

#include "report/file.h"
#include "report/plot_run.h"
#include "report/run_json.h"
#include "report/run_text.h"
#include "report/series_csv.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void say_written(const char *path, bool is_quiet)
{
    if (!is_quiet) {
        fprintf(stderr, "wrote %s\n", path);
    }
}

static bool write_text(const char *path, const char *text, bool is_quiet, Err *err)
{
    if (!file_write_text(path, text, err)) {
        return false;
    }
    say_written(path, is_quiet);
    return true;
}

static bool write_series(const CaseRun *run, const Trajectory *trajectory, const char *path,
                         bool is_quiet, Err *err)
{
    if (!series_csv_write(&run->scenario, trajectory, path, err)) {
        return false;
    }
    say_written(path, is_quiet);
    return true;
}

bool run_files_series(const CaseRun *run, const char *path, bool is_quiet, Err *err)
{
    // a stream takes all series as it is; a name is only made for files
    const size_t file_count = file_is_stream(path) ? 1 : run->report.run_count;
    for (size_t i = 0; i < run->report.run_count; i++) {
        const Trajectory *trajectory = run->runs[i];
        char target[FILE_PATH_SIZE];
        series_csv_path(path, trajectory->backend, file_count, target, sizeof target);
        if (trajectory->is_complete && !write_series(run, trajectory, target, is_quiet, err)) {
            return false;
        }
    }
    return true;
}

bool run_files_plot(const CaseRun *run, const char *path, bool is_quiet, Err *err)
{
    Text svg;
    text_init(&svg);
    plot_run_write(&run->report, &svg);
    const bool is_written = write_text(path, svg.data, is_quiet, err);
    text_finish(&svg);
    return is_written;
}

bool run_files_make_folder(const char *folder, Err *err)
{
    char path[FILE_PATH_SIZE];
    const int written = snprintf(path, sizeof path, "%s", folder);
    if (written <= 0 || (size_t)written >= sizeof path) {
        return err_set(err, ERR_FILE, "cannot make a folder of such a name");
    }
    // every part that ends in a slash, then the whole
    for (char *slash = strchr(path + 1, '/'); slash != NULL; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(path, 0777);
        *slash = '/';
    }
    struct stat status;
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return err_set(err, ERR_FILE, "cannot make the folder %s: %s", folder, strerror(errno));
    }
    if (stat(path, &status) != 0 || !S_ISDIR(status.st_mode)) {
        return err_set(err, ERR_FILE, "cannot make the folder %s: it is a file", folder);
    }
    return true;
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
    char *words = json_dumps(object, RUN_JSON_FLAGS);
    assert(words != NULL);
    Text text;
    text_init(&text);
    text_append(&text, "%s\n", words);
    const bool is_written = write_text(path, text.data, is_quiet, err);
    text_finish(&text);
    free(words);
    json_decref(object);
    return is_written;
}

static bool write_report(const CaseRun *run, const char *path, bool is_quiet, Err *err)
{
    Text text;
    text_init(&text);
    run_text_write(&run->report, &STYLE_PLAIN, &text);
    const bool is_written = write_text(path, text.data, is_quiet, err);
    text_finish(&text);
    return is_written;
}

bool run_files_folder(const CaseRun *run, const char *folder, bool is_quiet, Err *err)
{
    char name[FILE_PATH_SIZE];
    char path[FILE_PATH_SIZE];
    case_run_name(&run->scenario, name, sizeof name);
    for (size_t i = 0; i < run->report.run_count; i++) {
        const Trajectory *trajectory = run->runs[i];
        char ending[LINKAGE_NAME_SIZE + 8];
        snprintf(ending, sizeof ending, "-%s.csv", trajectory->backend);
        if (!join_path(folder, name, ending, path, err)) {
            return false;
        }
        if (!trajectory->is_complete) {
            // a series of an earlier run must not stand for one that failed
            remove(path);
        } else if (!write_series(run, trajectory, path, is_quiet, err)) {
            return false;
        }
    }
    return join_path(folder, name, ".svg", path, err) && run_files_plot(run, path, is_quiet, err) &&
           join_path(folder, name, ".txt", path, err) && write_report(run, path, is_quiet, err) &&
           join_path(folder, name, ".json", path, err) && write_json(run, path, is_quiet, err);
}

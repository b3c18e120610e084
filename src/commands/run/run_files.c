// Which series does a run leave behind, and what are their files called?
#include "commands/run/run_files.h"

#include "cli/results.h"
#include "cli/written.h"
#include "write/file.h"
#include "write/series_rows.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

bool series_csv_write(const Scenario *scenario, const Trajectory *trajectory, const char *path,
                      Err *err)
{
    assert(trajectory->is_complete);
    WholeFile file;
    if (!file_begin(&file, FILE_TABLE, path, err)) {
        return false;
    }
    series_rows_write(scenario, trajectory, file.stream);
    return file_end(&file, err);
}

void series_csv_path(const char *path, const char *backend, size_t run_count, char *target,
                     size_t size)
{
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash == NULL ? path : slash + 1, '.');
    const size_t stem = dot == NULL ? strlen(path) : (size_t)(dot - path);
    if (run_count == 1) {
        snprintf(target, size, "%s", path);
    } else {
        snprintf(target, size, "%.*s-%s%s", (int)stem, path, backend, path + stem);
    }
}

static bool write_series(const CaseRun *run, const Trajectory *trajectory, const char *path,
                         bool is_quiet, Err *err)
{
    return series_csv_write(&run->scenario, trajectory, path, err) && written_say(path, is_quiet);
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

bool run_files_claim(const CaseRun *run, const char *series, Err *err)
{
    // a stream takes all of them
    const size_t count = file_is_stream(series) ? 1 : run->scenario.run.backend_count;
    bool is_claimed = file_check_input("--series", series, err);
    for (size_t i = 0; i < count && is_claimed; i++) {
        char target[FILE_PATH_SIZE];
        find_series(run, series, i, target);
        is_claimed = file_claim("--series", FILE_TABLE, target, err);
    }
    return is_claimed;
}

// The file of a backend's series in the folder.
static bool find_member(const CaseRun *run, const CommonOptions *options, size_t number, char *path,
                        Err *err)
{
    char name[SCENARIO_PATH_SIZE];
    char ending[LINKAGE_NAME_SIZE + 8];
    const RunOptions *backends = &run->scenario.run;
    file_stem(scenario_path(&run->scenario), name, sizeof name);
    snprintf(ending, sizeof ending, "-%s.csv", OPTIONS_BACKENDS[backends->backends[number]]);
    return results_path(options, name, ending, path, err);
}

bool run_files_claim_folder(const CaseRun *run, const CommonOptions *options, Err *err)
{
    char path[FILE_PATH_SIZE];
    for (size_t i = 0; i < run->scenario.run.backend_count; i++) {
        if (!find_member(run, options, i, path, err) ||
            !file_claim("--out", FILE_TABLE, path, err)) {
            return false;
        }
    }
    return true;
}

bool run_files_folder(const CaseRun *run, const CommonOptions *options, Err *err)
{
    char path[FILE_PATH_SIZE];
    for (size_t i = 0; i < run->report.run_count; i++) {
        const Trajectory *trajectory = run->runs[i];
        if (!find_member(run, options, i, path, err)) {
            return false;
        }
        if (!trajectory->is_complete) {
            // a series of an earlier run must not stand for one that failed
            file_remove(FILE_TABLE, path);
        } else if (!write_series(run, trajectory, path, options->is_quiet, err)) {
            return false;
        }
    }
    return true;
}

// Writes the series and contacts of a case's runs, and shows how far these have come.
#include "commands/run/run_files.h"
#include "cli/long_work.h"
#include "cli/results.h"
#include "cli/written.h"
#include "write/contact_table.h"
#include "write/file.h"
#include "write/row_file.h"
#include "write/series_rows.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

// What is shown meanwhile.

static ChosenWatch begin_shown(const char *doing, void *context)
{
    Progress *progress = context;
    const ChosenWatch watch = progress_watch_trials(progress, doing);
    // of long work that was announced nobody is warned once more
    progress->is_warned =
        progress->is_announced && strcmp(doing, OPTIONS_BACKENDS[BACKEND_ODE]) == 0;
    return watch;
}

static void end_shown(void *context)
{
    progress_end(context);
}

static void announce(const Scenario *scenario, void *context)
{
    Progress *progress = context;
    progress->is_announced = long_work_announce(scenario, progress->line.is_quiet);
}

CaseWatch run_files_watch(Progress *progress)
{
    return (CaseWatch){begin_shown, end_shown, announce, progress};
}

// The series that a run leaves behind, and the names of their files.

bool run_files_check_columns(const CaseRun *run, Err *err)
{
    if (run->columns == NULL) {
        return true;
    }
    SeriesColumns columns = series_columns_create(&run->scenario, run->scenario.run.keeps_ranges);
    const bool has_them = series_columns_check(&columns, run->columns, err);
    series_columns_finish(&columns);
    return has_them;
}

// The columns of a run's series, those that are chosen; for series_columns_finish.
static SeriesColumns choose_columns(const Scenario *scenario, const char *patterns, bool has_ranges)
{
    SeriesColumns columns = series_columns_create(scenario, has_ranges);
    if (patterns != NULL) {
        series_columns_choose(&columns, patterns);
    }
    return columns;
}

bool series_write(const Scenario *scenario, const Trajectory *trajectory, const char *patterns,
                  const char *path, Err *err)
{
    assert(trajectory->is_complete);
    SeriesColumns columns = choose_columns(scenario, patterns, trajectory->ranges.count > 0);
    const bool is_written = series_columns_write(&columns, trajectory, path, err);
    series_columns_finish(&columns);
    return is_written;
}

void series_path(const char *path, const char *backend, size_t run_count, char *target, size_t size)
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
    return series_write(&run->scenario, trajectory, run->columns, path, err) &&
           written_say(path, is_quiet);
}

static bool write_contacts(const CaseRun *run, const Trajectory *trajectory, const char *path,
                           bool is_quiet, Err *err)
{
    (void)run;
    return contact_table_write(trajectory, path, err) && written_say(path, is_quiet);
}

// A table of each run.
typedef struct RunTableFile {
    const char *option;
    bool (*write)(const CaseRun *run, const Trajectory *trajectory, const char *path, bool is_quiet,
                  Err *err);
} RunTableFile;

static const RunTableFile TABLES[] = {
    [RUN_SERIES] = {"--series", write_series},
    [RUN_CONTACTS] = {"--contacts", write_contacts},
};

// The file that a run's series goes to.
static void find_series(const CaseRun *run, const char *path, size_t number, char *target)
{
    const RunOptions *options = &run->scenario.run;
    // a stream takes all series as it is; a name is only made for files
    const size_t file_count = file_is_stream(path) ? 1 : options->backend_count;
    series_path(path, OPTIONS_BACKENDS[options->backends[number]], file_count, target,
                FILE_PATH_SIZE);
}

bool run_files_write(const CaseRun *run, RunTable table, const char *path, bool is_quiet, Err *err)
{
    for (size_t i = 0; i < run->report.run_count; i++) {
        const Trajectory *trajectory = run->runs[i];
        char target[FILE_PATH_SIZE];
        find_series(run, path, i, target);
        if (trajectory->is_complete &&
            !TABLES[table].write(run, trajectory, target, is_quiet, err)) {
            return false;
        }
    }
    return true;
}

bool run_files_claim(const CaseRun *run, RunTable table, const char *path, Err *err)
{
    // a stream takes all of them
    const size_t count = file_is_stream(path) ? 1 : run->scenario.run.backend_count;
    const RunTableFile *of = &TABLES[table];
    bool is_claimed = file_check_input(of->option, path, err);
    for (size_t i = 0; i < count && is_claimed; i++) {
        char target[FILE_PATH_SIZE];
        find_series(run, path, i, target);
        is_claimed = row_file_claim(of->option, target, err);
    }
    return is_claimed;
}

// What each run has in the folder: its series, and with play its contacts.
typedef struct FolderFile {
    const char *ending; // behind the names of case and backend
    RunTable table;
} FolderFile;

static const FolderFile FOLDER_FILES[] = {
    {".csv", RUN_SERIES},
    {"-contacts.csv", RUN_CONTACTS},
};
enum { FOLDER_FILE_COUNT = sizeof FOLDER_FILES / sizeof *FOLDER_FILES };

// Whether a backend has a file; the closed form has no contacts.
static bool has_file(const CaseRun *run, const FolderFile *file, size_t number)
{
    return file->table != RUN_CONTACTS || (scenario_has_clearance(&run->scenario) &&
                                           run->scenario.run.backends[number] != BACKEND_ANALYTIC);
}

static bool case_run_find_member(const CaseRun *run, const CommonOptions *options,
                                 const FolderFile *file, size_t number, char *path, Err *err)
{
    char name[SCENARIO_PATH_SIZE];
    char ending[LINKAGE_NAME_SIZE + 16];
    const RunOptions *backends = &run->scenario.run;
    file_stem(scenario_path(&run->scenario), name, sizeof name);
    snprintf(ending, sizeof ending, "-%s%s", OPTIONS_BACKENDS[backends->backends[number]],
             file->ending);
    return results_path(options, name, ending, path, err);
}

bool run_files_claim_folder(const CaseRun *run, const CommonOptions *options, Err *err)
{
    char path[FILE_PATH_SIZE];
    for (size_t i = 0; i < FOLDER_FILE_COUNT * run->scenario.run.backend_count; i++) {
        const FolderFile *file = &FOLDER_FILES[i % FOLDER_FILE_COUNT];
        const size_t number = i / FOLDER_FILE_COUNT;
        if (has_file(run, file, number) &&
            (!case_run_find_member(run, options, file, number, path, err) ||
             !row_file_claim("--out", path, err))) {
            return false;
        }
    }
    return true;
}

static bool write_member(const CaseRun *run, const CommonOptions *options, const FolderFile *file,
                         size_t number, Err *err)
{
    char path[FILE_PATH_SIZE];
    const Trajectory *trajectory = run->runs[number];
    if (!case_run_find_member(run, options, file, number, path, err)) {
        return false;
    }
    if (!trajectory->is_complete) {
        // a file of an earlier run must not stand for one that failed
        file_remove(FILE_TABLE, path);
        return true;
    }
    return TABLES[file->table].write(run, trajectory, path, options->is_quiet, err);
}

bool run_files_folder(const CaseRun *run, const CommonOptions *options, Err *err)
{
    for (size_t i = 0; i < FOLDER_FILE_COUNT * run->report.run_count; i++) {
        const FolderFile *file = &FOLDER_FILES[i % FOLDER_FILE_COUNT];
        const size_t number = i / FOLDER_FILE_COUNT;
        if (has_file(run, file, number) && !write_member(run, options, file, number, err)) {
            return false;
        }
    }
    return true;
}

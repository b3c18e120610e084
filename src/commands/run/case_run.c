// Runs a case on its backends, with reference and ensembles, and writes the series of the runs.
#include "commands/run/case_run.h"
#include "base/clock.h"
#include "base/side_by_side.h"
#include "base/zeroed.h"
#include "casefile/input.h"
#include "cli/long_work.h"
#include "cli/results.h"
#include "cli/written.h"
#include "measure/chosen_run.h"
#include "run/registry.h"
#include "run/settle.h"
#include "run/tracer.h"
#include "write/contact_table.h"
#include "write/file.h"
#include "write/row_file.h"
#include "write/series_rows.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

// The run of a backend that is complete, or NULL.
static const Trajectory *find_run(const CaseRun *run, BackendKind backend)
{
    for (size_t i = 0; i < run->scenario.run.backend_count; i++) {
        if (run->scenario.run.backends[i] == backend && run->runs[i]->is_complete) {
            return run->runs[i];
        }
    }
    return NULL;
}

static bool uses(const CaseRun *run, BackendKind backend)
{
    const RunOptions *options = &run->scenario.run;
    for (size_t i = 0; i < options->backend_count; i++) {
        if (options->backends[i] == backend) {
            return true;
        }
    }
    return false;
}

static void case_run_make_truth(CaseRun *run, Progress *progress)
{
    if (!uses(run, BACKEND_REFERENCE)) {
        return;
    }
    const RunWatch watch = progress_watch(progress, "reference");
    run->truth = run->is_uncertified
                     ? truth_make_uncertified(&run->scenario, watch)
                     : truth_make_on(&run->scenario, watch, side_by_side_processors());
    progress_end(progress);
    run->report.truth = &run->truth;
}

// One run of one backend; the truth's own trajectory stands for the run of its backend.
static Trajectory *case_run_run_backend(const CaseRun *run, BackendKind backend, bool is_announced,
                                        Progress *progress)
{
    const Solver *solver = registry_solver(backend);
    Trajectory *truth = run->truth.trajectory;
    if (truth != NULL && strcmp(truth->backend, solver->name) == 0) {
        return truth;
    }
    ChosenWatch watch = progress_watch_trials(progress, solver->name);
    watch.budget_s = run->scenario.run.budget;
    progress->is_warned = is_announced;
    Trajectory *trajectory = backend_run(&run->scenario, backend,
                                         truth == NULL ? NULL : &run->truth, watch, &TRACER_PROBE);
    progress_end(progress);
    return trajectory;
}

// Errors are against the certified solution; without one, against the closed form.
static void measure_errors(CaseRun *run)
{
    const bool has_truth = run_report_has_truth(&run->report);
    const Trajectory *truth = has_truth ? run->truth.trajectory : find_run(run, BACKEND_ANALYTIC);
    const double horizon = run_report_horizon(&run->report);
    for (size_t i = 0; truth != NULL && i < run->scenario.run.backend_count; i++) {
        if (run->runs[i] != truth && run->runs[i]->is_complete) {
            run->errors[i] = error_against(run->runs[i], truth, horizon);
            run->failed_count += error_fail_unstable(run->runs[i], truth, &run->errors[i]) ? 1 : 0;
        }
    }
    for (size_t i = 0; truth == NULL && i < run->scenario.run.backend_count; i++) {
        run->failed_count += error_fail_runaway(&run->scenario, run->runs[i]) ? 1 : 0;
    }
}

// The contacts of every run that lets the play happen, beside the truth's.
static void match_contacts(CaseRun *run)
{
    const Linkage *linkage = &run->scenario.linkage;
    for (size_t i = 0; i < run->scenario.run.backend_count; i++) {
        const Trajectory *trajectory = run->runs[i];
        run->matches[i].joints = zeroed(linkage->joint_count, sizeof *run->matches[i].joints);
        for (size_t k = 0; trajectory != run->truth.trajectory && k < linkage->joint_count; k++) {
            if (trajectory_feels_play(trajectory, &linkage->joints[k])) {
                run->matches[i].joints[k] =
                    spike_match(trajectory, run->truth.trajectory, k, run->truth.horizon_s,
                                spike_match_reach(&run->scenario));
            }
        }
    }
    run->report.matches = run->matches;
}

// World steps to a step of one that was chosen: a gear of 2.
static const double STEPS_TO_ONE = 2.0;

// Starts at least, whose numbers are a distribution.
static const double STARTS_LEAST = 2.0;

// Processor time that is left of the budget for starts beside one, s; 0: as long as they take.
// False where it is not enough for some.
static bool has_budget(const CaseRun *run, size_t number, double *left_s)
{
    const Trajectory *made = run->runs[number];
    const double budget_s = run->scenario.run.budget;
    *left_s = 0.0;
    if (budget_s == 0.0) {
        return true;
    }
    *left_s = budget_s - run->spent_s[number];
    const double share = made->trials > 0 && made->step_s > 0.0
                             ? STEPS_TO_ONE * made->duration_s / made->step_s / (double)made->steps
                             : 1.0;
    return *left_s > STARTS_LEAST * fmin(share, 1.0) * run->spent_s[number];
}

// Where the motion cannot be predicted, its statistics may still agree: of the first screen those
// of the settled motion are a part, and these are not.
static void run_ensembles(CaseRun *run, Progress *progress)
{
    const RunOptions *options = &run->scenario.run;
    for (size_t i = 0; i < options->backend_count; i++) {
        double left_s;
        if (!OPTIONS_BACKEND_HAS_PLAY[options->backends[i]] || !run->runs[i]->is_complete) {
            continue;
        }
        if (!has_budget(run, i, &left_s)) {
            run->ensembles[i].is_beyond_budget = true;
            continue;
        }
        const Solver *solver = registry_solver(options->backends[i]);
        char name[LINKAGE_NAME_SIZE];
        snprintf(name, sizeof name, "%s, %d starts", solver->name, ENSEMBLE_MEMBERS);
        const RunWatch watch = progress_watch(progress, name);
        // a step that was chosen once is good for starts beside this one
        const bool is_chosen = backend_run_is_chosen(&run->scenario, options->backends[i]);
        const Scenario scenario =
            is_chosen ? chosen_run_scenario(&run->scenario, run->runs[i]->step_s) : run->scenario;
        ensemble_run(&scenario, solver, left_s, watch, &run->ensembles[i]);
        progress_end(progress);
    }
    run->report.ensembles = run->ensembles;
}

// What the closed form has to say beyond its trajectory, where it took part.
static void ask_closed_form(CaseRun *run)
{
    const Scenario *scenario = &run->scenario;
    if (find_run(run, BACKEND_ANALYTIC) == NULL || !scenario_has_closed_form(scenario)) {
        return;
    }
    // a crank that does not turn fully has no turn to sum up: no error, but said
    if (summary_compute(scenario, &run->summary, &run->summary_err)) {
        run->report.summary = &run->summary;
    } else {
        run->report.no_summary = run->summary_err.text;
    }
    if (stackup_compute(scenario, &run->stackup, &run->stackup_err)) {
        run->report.stackup = &run->stackup;
    } else {
        run->report.no_stackup = run->stackup_err.text;
    }
}

// How far inputs and assumptions move the settled motion. A case that cannot be read once more has
// no range.
static void find_spread(CaseRun *run, Progress *progress)
{
    const char *name = scenario_path(&run->scenario);
    char *text;
    size_t size;
    Err unused = {ERR_NONE, ""};
    const bool is_stdin = strcmp(run->path, "-") == 0;
    if (run->is_quick || !spread_is_of(&run->scenario) ||
        !(is_stdin ? input_read_stdin("case", &text, &size, &unused)
                   : input_read("case", run->path, &text, &size, &unused))) {
        return;
    }
    const SpreadCase of = {name, text, size, run->options->overrides, run->options->override_count};
    SpreadOptions options = spread_options_default();
    options.budget_s = run->scenario.run.budget;
    run->spread = spread_find(&of, &run->scenario, &options,
                              progress_watch(progress, "the range over the inputs"));
    progress_end(progress);
    run->report.spread = &run->spread;
    free(text);
}

// What lies beside the settled motion: the growth of small changes is not on the first screen.
static void look_beside(CaseRun *run, Progress *progress)
{
    if (run->is_whole) {
        settle_growth(&run->scenario, progress_watch(progress, "growth of small changes"));
    }
    find_spread(run, progress);
}

// Hands on what the reference says, before anything else is run. Not where the closed form is the
// truth: the first screen is then of a run of the reference, which is still to come.
static void hand_on_answer(CaseRun *run)
{
    Trajectory *truth = run->truth.trajectory;
    if (run->answered == NULL || truth == NULL || !truth->is_complete ||
        strcmp(truth->backend, OPTIONS_BACKENDS[BACKEND_REFERENCE]) != 0) {
        return;
    }
    const TrajectoryError errors[1] = {{.is_known = false}};
    const RunReport report = {
        .scenario = &run->scenario,
        .run_count = 1,
        .runs = &truth,
        .errors = errors,
        .truth = &run->truth,
        .is_quick = run->is_quick,
    };
    run->answered(&report, run->listener);
}

void case_run_execute(CaseRun *run, Progress *progress)
{
    const RunOptions *options = &run->scenario.run;
    settle_scenario(&run->scenario, progress_watch(progress, SETTLING));
    run->report = (RunReport){
        .scenario = &run->scenario,
        .run_count = options->backend_count,
        .runs = run->runs,
        .errors = run->errors,
        .is_quick = run->is_quick,
    };
    const bool is_announced = long_work_announce(&run->scenario, progress->line.is_quiet);
    case_run_make_truth(run, progress);
    hand_on_answer(run);
    look_beside(run, progress);
    for (size_t i = 0; i < options->backend_count; i++) {
        const double began_s = clock_processor_s();
        run->runs[i] =
            case_run_run_backend(run, options->backends[i],
                                 is_announced && options->backends[i] == BACKEND_ODE, progress);
        run->spent_s[i] = clock_processor_s() - began_s;
        run->failed_count += run->runs[i]->is_complete ? 0 : 1;
    }
    measure_errors(run);
    ask_closed_form(run);
    if (run_report_has_truth(&run->report) && scenario_has_clearance(&run->scenario)) {
        match_contacts(run);
        if (run->truth.is_limited && run->is_whole) {
            run_ensembles(run, progress);
        }
    }
}

void case_run_finish(CaseRun *run)
{
    for (size_t i = 0; i < BACKEND_COUNT; i++) {
        if (run->runs[i] != run->truth.trajectory) {
            trajectory_destroy(run->runs[i]);
        }
        run->runs[i] = NULL;
        free(run->matches[i].joints);
    }
    spread_free(&run->spread);
    truth_finish(&run->truth);
    scenario_free(&run->scenario);
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

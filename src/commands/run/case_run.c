// Runs a case on its backends, with reference and ensembles.
#include "commands/run/case_run.h"
#include "base/clock.h"
#include "base/side_by_side.h"
#include "base/zeroed.h"
#include "casefile/input.h"
#include "run/registry.h"
#include "run/settle.h"
#include "run/tracer.h"

#include <stdio.h>
#include <string.h>

static ChosenWatch watch_begin(const CaseWatch *watch, const char *doing)
{
    return watch->begin(doing, watch->context);
}

static void watch_end(const CaseWatch *watch)
{
    watch->end(watch->context);
}

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

static void case_run_make_truth(CaseRun *run, const CaseWatch *watch)
{
    if (!uses(run, BACKEND_REFERENCE)) {
        return;
    }
    const RunWatch seen = watch_begin(watch, "reference").run;
    run->truth = run->is_uncertified
                     ? truth_make_uncertified(&run->scenario, seen)
                     : truth_make_on(&run->scenario, seen, side_by_side_processors());
    watch_end(watch);
    run->report.truth = &run->truth;
}

// One run of one backend; the truth's own trajectory stands for the run of its backend.
static Trajectory *case_run_run_backend(const CaseRun *run, BackendKind backend,
                                        const CaseWatch *watch)
{
    const Solver *solver = registry_solver(backend);
    Trajectory *truth = run->truth.trajectory;
    if (truth != NULL && strcmp(truth->backend, solver->name) == 0) {
        return truth;
    }
    ChosenWatch seen = watch_begin(watch, solver->name);
    seen.budget_s = run->scenario.run.budget;
    Trajectory *trajectory = backend_run(&run->scenario, backend,
                                         truth == NULL ? NULL : &run->truth, seen, &TRACER_PROBE);
    watch_end(watch);
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
static void run_ensembles(CaseRun *run, const CaseWatch *watch)
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
        const RunWatch seen = watch_begin(watch, name).run;
        // a step that was chosen once is good for starts beside this one
        const bool is_chosen = backend_run_is_chosen(&run->scenario, options->backends[i]);
        const Scenario scenario =
            is_chosen ? chosen_run_scenario(&run->scenario, run->runs[i]->step_s) : run->scenario;
        ensemble_run(&scenario, solver, left_s, seen, &run->ensembles[i]);
        watch_end(watch);
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
static void find_spread(CaseRun *run, const CaseWatch *watch)
{
    SpreadCase of = run->as_read;
    char *read = NULL;
    Err unused = {ERR_NONE, ""};
    if (run->is_quick || !spread_is_of(&run->scenario)) {
        return;
    }
    of.name = scenario_path(&run->scenario);
    if (of.text == NULL) {
        const bool is_stdin = strcmp(run->path, "-") == 0;
        if (!(is_stdin ? input_read_stdin("case", &read, &of.size, &unused)
                       : input_read("case", run->path, &read, &of.size, &unused))) {
            return;
        }
        of.text = read;
    }
    SpreadOptions options = spread_options_default();
    options.budget_s = run->scenario.run.budget;
    run->spread = spread_find(&of, &run->scenario, &options,
                              watch_begin(watch, "the range over the inputs").run);
    watch_end(watch);
    run->report.spread = &run->spread;
    free(read);
}

// What lies beside the settled motion: the growth of small changes is not on the first screen.
static void look_beside(CaseRun *run, const CaseWatch *watch)
{
    if (run->is_whole) {
        settle_growth(&run->scenario, watch_begin(watch, "growth of small changes").run);
    }
    find_spread(run, watch);
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

// A step is chosen by its error against a reference whose own is known.
static bool check_uncertified(const Scenario *scenario, Err *err)
{
    for (size_t i = 0; i < scenario->run.backend_count; i++) {
        const BackendKind backend = scenario->run.backends[i];
        if (backend_run_is_chosen(scenario, backend)) {
            const char *name = OPTIONS_BACKENDS[backend];
            return err_set(err, ERR_USAGE,
                           "%s: the step of %s is chosen by its error against the certified "
                           "reference; with --uncertified give --step TIME, or --backend without "
                           "%s",
                           scenario_path(scenario), name, name);
        }
    }
    return true;
}

// What a backend cannot run is said before a start is looked for and others run.
static bool check_backends(const Scenario *scenario, Err *err)
{
    const bool is_right = registry_check(scenario, err);
    if (!is_right) {
        err_prefix(err, scenario_path(scenario));
    }
    return is_right;
}

bool case_run_check(const CaseRun *run, Err *err)
{
    return (!run->is_uncertified || check_uncertified(&run->scenario, err)) &&
           check_backends(&run->scenario, err);
}

void case_run_execute(CaseRun *run, const CaseWatch *watch)
{
    const RunOptions *options = &run->scenario.run;
    settle_scenario(&run->scenario, watch_begin(watch, SETTLE_DOING).run);
    run->report = (RunReport){
        .scenario = &run->scenario,
        .run_count = options->backend_count,
        .runs = run->runs,
        .errors = run->errors,
        .is_quick = run->is_quick,
    };
    if (watch->settled != NULL) {
        watch->settled(&run->scenario, watch->context);
    }
    case_run_make_truth(run, watch);
    hand_on_answer(run);
    look_beside(run, watch);
    for (size_t i = 0; i < options->backend_count; i++) {
        const double began_s = clock_processor_s();
        run->runs[i] = case_run_run_backend(run, options->backends[i], watch);
        run->spent_s[i] = clock_processor_s() - began_s;
        run->failed_count += run->runs[i]->is_complete ? 0 : 1;
    }
    measure_errors(run);
    ask_closed_form(run);
    if (run_report_has_truth(&run->report) && scenario_has_clearance(&run->scenario)) {
        match_contacts(run);
        if (run->truth.is_limited && run->is_whole) {
            run_ensembles(run, watch);
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

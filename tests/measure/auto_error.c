// Is a run at `step: auto` ever above its tolerance, or above what it says its error is?
//
// auto_error KIND FIRST LAST [LADDER]
// Runs the random cases of those seeds, cut to a tenth of a turn or 0.05 s, at four tolerances. The
// judge is not the reference that the steps were chosen against: it is made at another tolerance
// and in another frame, so that its rounding is another. Every LADDER-th case (0: none) is also run
// at fixed steps, each 1.26 times finer, for the work of the best of them.
// One line a run; a summary at the end.
#include "random_scenario.h"

#include "base/clock.h"
#include "casefile/casefile.h"
#include "measure/child.h"
#include "measure/chosen_run.h"
#include "measure/error.h"
#include "model/kinematics.h"
#include "run/registry.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { TOLERANCE_COUNT = 4, RUN_MAX = 4096, LADDER_MAX = 64 };

static const double TOLERANCES[TOLERANCE_COUNT] = {1e-3, 1e-4, 1e-5, 1e-6};
static const double JUDGE_TOLERANCE = 1e-14;
static const double RATIO = 1.26; // of two steps of the ladder
static const double LADDER_STEPS_LEAST = 10.0;
static const double LADDER_STEPS_MOST = 1e5;
static const double TIME_LIMIT_S = 120.0; // of one case

typedef struct Run {
    char message[160];
    bool is_complete;
    bool is_short;
    size_t trials;
    size_t steps;
    double step_s;
    double estimate;
    double until_s;
    double error; // against the judge, up to there
    size_t evaluations;
    size_t best; // world steps of the best fixed step; 0: not looked for, or not found
} Run;

typedef struct Result {
    char message[160]; // why the case could not be judged
    double uncertainty;
    double horizon_s;
    double duration_s;
    double truth_s; // of the clock, like the next two
    double runs_s;
    double ladder_s;
    Run runs[TOLERANCE_COUNT];
} Result;

typedef struct Work {
    const CaseKind *kind;
    uint64_t seed;
    bool with_ladder;
} Work;

static bool load(const Work *work, Scenario *scenario, Err *err)
{
    static const char *const CUT[] = {"run.step=auto", "run.most-steps=300000"};
    const bool is_loaded = random_scenario(work->kind, work->seed, CUT, 2, scenario, err);
    scenario->run.revolutions = fmin(scenario->run.revolutions, 0.1);
    if (!scenario->linkage.driver.is_present) {
        scenario->run.duration = fmin(scenario->run.duration, 0.05);
    }
    return is_loaded;
}

static void run_auto(const Scenario *scenario, const Truth *truth, const Trajectory *judge,
                     Run *result)
{
    Trajectory *run = backend_run(scenario, BACKEND_ODE, truth, (ChosenWatch){.begin = NULL}, NULL);
    result->is_complete = run->is_complete;
    snprintf(result->message, sizeof result->message, "%.150s", run->message);
    result->trials = run->trials;
    result->steps = run->steps;
    result->evaluations = run->evaluations;
    if (run->is_complete) {
        result->is_short = run->is_short;
        result->step_s = run->step_s;
        result->estimate = run->error_estimate;
        result->until_s = run->estimate_s;
        result->error = apart_until(run, judge, truth->trajectory, run->estimate_s);
    }
    trajectory_destroy(run);
}

// World steps of the coarsest fixed steps that hold the tolerances.
static void run_ladder(const Scenario *scenario, const Truth *truth, const Trajectory *judge,
                       Result *result)
{
    double step_s = result->duration_s / LADDER_STEPS_LEAST;
    size_t missing = TOLERANCE_COUNT;
    for (int i = 0; i < LADDER_MAX && missing > 0; i++, step_s /= RATIO) {
        if (result->duration_s / step_s > LADDER_STEPS_MOST) {
            break;
        }
        Scenario fixed = scenario_with_step(scenario, step_s);
        fixed.ode.gear = 1;
        Trajectory *run =
            run_scenario(&fixed, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
        const double error = run->is_complete
                                 ? apart_until(run, judge, truth->trajectory, result->horizon_s)
                                 : INFINITY;
        for (int k = 0; k < TOLERANCE_COUNT; k++) {
            if (error <= TOLERANCES[k] && result->runs[k].best == 0) {
                result->runs[k].best = run->steps;
                missing--;
            }
        }
        trajectory_destroy(run);
    }
}

static void measure(const void *context, void *target)
{
    const Work *work = context;
    Result *result = target;
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    memset(result, 0, sizeof *result);
    if (!load(work, &scenario, &err)) {
        snprintf(result->message, sizeof result->message, "%.150s", err.text);
        return;
    }
    result->duration_s = scenario_duration(&scenario);
    double started_s = clock_now_s();
    Truth truth = truth_make(&scenario, (RunWatch){NULL, NULL});
    result->truth_s = clock_now_s() - started_s;
    result->uncertainty = truth.uncertainty;
    result->horizon_s = truth.is_limited ? truth.horizon_s : result->duration_s;
    const Scenario other = moved_scenario(&scenario, JUDGE_TOLERANCE);
    Trajectory *judge =
        run_scenario(&other, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
    if (!judge->is_complete) {
        snprintf(result->message, sizeof result->message, "judge: %.140s", judge->message);
    }
    move_back(judge);
    started_s = clock_now_s();
    for (int i = 0; result->message[0] == '\0' && i < TOLERANCE_COUNT; i++) {
        scenario.run.tolerance = TOLERANCES[i];
        run_auto(&scenario, &truth, judge, &result->runs[i]);
    }
    result->runs_s = clock_now_s() - started_s;
    started_s = clock_now_s();
    if (work->with_ladder && result->message[0] == '\0' && truth.trajectory->is_complete) {
        run_ladder(&scenario, &truth, judge, result);
    }
    result->ladder_s = clock_now_s() - started_s;
    trajectory_destroy(judge);
    truth_finish(&truth);
}

typedef struct Summary {
    size_t cases;
    size_t unjudged;
    size_t whole;
    size_t shorter;
    size_t failed;
    size_t above;     // the tolerance
    size_t above_own; // what the run says
    double worst;     // error over tolerance
    double worst_own; // error over estimate
    size_t ratio_count;
    double ratios[RUN_MAX];
} Summary;

static int compare(const void *a, const void *b)
{
    const double first = *(const double *)a;
    const double second = *(const double *)b;
    return (first > second) - (first < second);
}

static void add(Summary *summary, const Run *run, double tolerance)
{
    if (!run->is_complete) {
        summary->failed++;
        return;
    }
    summary->whole += run->is_short ? 0 : 1;
    summary->shorter += run->is_short ? 1 : 0;
    summary->above += run->error <= tolerance ? 0 : 1;
    summary->above_own += run->error <= run->estimate ? 0 : 1;
    summary->worst = fmax(summary->worst, run->error / tolerance);
    if (run->estimate > 0.0) {
        summary->worst_own = fmax(summary->worst_own, run->error / run->estimate);
    }
    if (run->best > 0 && summary->ratio_count < RUN_MAX) {
        summary->ratios[summary->ratio_count++] = (double)run->steps / (double)run->best;
    }
}

static void print_case(const Work *work, const Result *result)
{
    printf("case %s %llu: %s horizon %.4g of %.4g ms, uncertainty %.2g; truth %.2f s, runs %.2f s, "
           "ladder %.2f s\n",
           work->kind->name, (unsigned long long)work->seed, result->message,
           1e3 * result->horizon_s, 1e3 * result->duration_s, result->uncertainty, result->truth_s,
           result->runs_s, result->ladder_s);
    for (int i = 0; result->message[0] == '\0' && i < TOLERANCE_COUNT; i++) {
        const Run *run = &result->runs[i];
        printf("  %.0e %s h %.4g us, %zu trials, %zu evals, %zu steps (best %zu), estimate %.3g to "
               "%.4g ms, "
               "error %.3g %s\n",
               TOLERANCES[i],
               !run->is_complete ? "FAILED"
               : run->is_short   ? "short"
                                 : "whole",
               1e6 * run->step_s, run->trials, run->evaluations, run->steps, run->best,
               run->estimate, 1e3 * run->until_s, run->error, run->message);
    }
    fflush(stdout);
}

static void print_summary(const Summary *summaries)
{
    printf("tolerance  whole  short  failed  above tol  above est  worst/tol  worst/est  "
           "work median  worst (of)\n");
    for (int i = 0; i < TOLERANCE_COUNT; i++) {
        Summary summary = summaries[i];
        qsort(summary.ratios, summary.ratio_count, sizeof(double), compare);
        const size_t count = summary.ratio_count;
        printf("%9.0e  %5zu  %5zu  %6zu  %9zu  %9zu  %9.4f  %9.6f  %11.2f  %.2f (%zu)\n",
               TOLERANCES[i], summary.whole, summary.shorter, summary.failed, summary.above,
               summary.above_own, summary.worst, summary.worst_own,
               count > 0 ? summary.ratios[count / 2] : NAN,
               count > 0 ? summary.ratios[count - 1] : NAN, count);
    }
    printf("cases %zu, of which %zu could not be judged\n", summaries[0].cases,
           summaries[0].unjudged);
}

int main(int argc, char **argv)
{
    static const CaseKind *const KINDS[] = {
        &CASE_FOUR_BAR, &CASE_BODIES,  &CASE_SPRUNG,    &CASE_SLIDERS, &CASE_LIMITS,
        &CASE_BALLS,    &CASE_PENDULA, &CASE_FOUR_BARS, &CASE_HOLES,   &CASE_RACKS,
        &CASE_GEARS,    &CASE_CAMS,    &CASE_SLOTS,     &CASE_GROWING};
    const CaseKind *kind = NULL;
    for (size_t i = 0; argc > 3 && i < sizeof KINDS / sizeof *KINDS; i++) {
        kind = strcmp(argv[1], KINDS[i]->name) == 0 ? KINDS[i] : kind;
    }
    if (kind == NULL) {
        fprintf(stderr, "usage: auto_error KIND FIRST LAST [LADDER]\nkinds:");
        for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
            fprintf(stderr, " %s", KINDS[i]->name);
        }
        fprintf(stderr, "\n");
        return 2;
    }
    static Summary summaries[TOLERANCE_COUNT];
    const uint64_t first = strtoull(argv[2], NULL, 10);
    const uint64_t last = strtoull(argv[3], NULL, 10);
    const uint64_t ladder = argc > 4 ? strtoull(argv[4], NULL, 10) : 0;
    for (uint64_t seed = first; seed <= last; seed++) {
        const Work work = {kind, seed, ladder > 0 && seed % ladder == 0};
        Result result;
        Child child = {0};
        Err err = {ERR_NONE, ""};
        const ChildLimits limits = {.time_s = TIME_LIMIT_S, .memory_bytes = (size_t)4 << 30};
        if (!child_start(&child, measure, &work, &result, sizeof result, limits, &err)) {
            fprintf(stderr, "%s\n", err.text);
            return 4;
        }
        while (child.end == CHILD_RUNNING) {
            child_wait(&child, 1, 1.0);
        }
        if (child.end != CHILD_DONE) {
            char words[CHILD_TEXT_SIZE];
            child_describe(&child, words);
            memset(&result, 0, sizeof result);
            snprintf(result.message, sizeof result.message, "its process %.100s", words);
        }
        print_case(&work, &result);
        summaries[0].cases++;
        summaries[0].unjudged += result.message[0] != '\0' ? 1 : 0;
        for (int i = 0; result.message[0] == '\0' && i < TOLERANCE_COUNT; i++) {
            add(&summaries[i], &result.runs[i], TOLERANCES[i]);
        }
    }
    print_summary(summaries);
    return 0;
}

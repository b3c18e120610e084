// Do `compare` and `tune` find the same without the runs that they leave out?
//
// left_out KIND FIRST LAST [flaw]
// Of the random cases of those seeds, cut to a tenth of a turn or 0.05 s:
//   compare  every point of a ladder is run once. From the same runs a ladder that may leave points
//            out is filled; no point that is missing in it may be on the frontier of all, or the
//            cheapest for a target, by the processor's time.
//   tune     with --cost steps, by all settings and by those that no observed order rules out,
//            however short they are: the setting found and the cheapest plain one have to be equal.
// With `flaw` all points but the two coarsest of each scheme are missing, and the second search is
// for an error half as large: then differences have to be found. One line a case; 1 where one
// differs.
#include "random_scenario.h"

#include "commands/tune/tune.h"
#include "commands/tune/tune_search.h"
#include "measure/runner.h"
#include "measure/task.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RUNGS = 7 };

static const double RUNG_STEPS[RUNGS] = {200, 400, 1000, 2000, 4000, 10000, 20000}; // in a run
static const double TARGETS[] = {3e-2, 3e-3};
static const double TIME_LIMIT_S = 60.0; // of one run

static const CaseKind *const KINDS[] = {&CASE_FOUR_BAR, &CASE_BODIES, &CASE_SPRUNG, &CASE_SLIDERS,
                                        &CASE_LIMITS,   &CASE_ROTORS, &CASE_RUN_UPS};

static bool load(const CaseKind *kind, uint64_t seed, Scenario *scenario)
{
    Err err = {ERR_NONE, ""};
    static const char *const CUT[] = {"run.most-steps=300000"};
    if (!random_scenario(kind, seed, CUT, 1, scenario, &err)) {
        return false;
    }
    scenario->run.revolutions = fmin(scenario->run.revolutions, 0.1);
    if (!scenario->linkage.driver.is_present) {
        scenario->run.duration = fmin(scenario->run.duration, 0.05);
    }
    return scheme_check(scenario, &err);
}

// A ladder of the usual schemes, nothing run.
static Ladder *left_out_ladder(const Scenario *scenario, const Truth *truth)
{
    Scheme schemes[SCHEME_MAX];
    size_t count = scheme_list(scenario, schemes);
    scheme_keep_usual(schemes, &count);
    double steps[RUNGS];
    for (size_t i = 0; i < RUNGS; i++) {
        steps[i] = scenario_duration(scenario) / RUNG_STEPS[i];
    }
    Ladder *ladder = ladder_create(schemes, count, steps, RUNGS, LADDER_REPEAT_LEAST);
    ladder->truth = ladder_truth_of(truth, 0.0);
    ladder->samples = scenario_sample_count(scenario);
    return ladder;
}

// Makes the error runs of a ladder, and times each point by them.
static void left_out_fill(const Scenario *scenario, const Truth *truth, Ladder *ladder)
{
    for (size_t i = 0; i < ladder->point_count; i++) {
        const Task task = task_make(ladder, scenario, ladder_run(ladder, i), truth);
        LadderRun run;
        task_measure(&task, &run);
        run.wall_s = run.processor_s;
        assert(ladder_add(ladder, &run));
        run.kind = LADDER_TIMING;
        for (run.round = 0; run.round < LADDER_REPEAT_LEAST; run.round++) {
            assert(ladder_add(ladder, &run));
        }
    }
    ladder_conclude(ladder);
}

static bool is_missing(const Ladder *part, size_t point, bool is_flawed)
{
    size_t rung = 0;
    while (!part->points[point - rung].is_first) {
        rung++;
    }
    return is_flawed ? rung > 1 : part->points[point].is_left_out;
}

typedef struct Found {
    size_t points;
    size_t left_out;
    size_t wrong; // left out, and on the frontier or the cheapest
} Found;

static Found compare_ladders(const Scenario *scenario, const Truth *truth, bool is_flawed)
{
    Ladder *whole = left_out_ladder(scenario, truth);
    Ladder *part = left_out_ladder(scenario, truth);
    left_out_fill(scenario, truth, whole);
    part->is_whole = false;
    for (size_t i = ladder_next(part, 0); i < part->point_count; i = ladder_next(part, i)) {
        assert(ladder_add(part, &whole->points[ladder_run(part, i).point].run));
    }
    Found found = {.points = whole->point_count};
    for (size_t i = 0; i < whole->point_count; i++) {
        bool is_needed = whole->points[i].is_on_frontier;
        for (size_t k = 0; k < LADDER_TARGET_COUNT; k++) {
            is_needed = is_needed || whole->cheapest[k] == i;
        }
        const bool is_gone = is_missing(part, i, is_flawed);
        found.left_out += is_gone ? 1 : 0;
        found.wrong += is_gone && is_needed ? 1 : 0;
    }
    ladder_destroy(whole);
    ladder_destroy(part);
    return found;
}

static void wait_for_nothing(const char *doing, double left_s, void *context)
{
    (void)doing;
    (void)left_s;
    (void)context;
}

// What a search finds, in words, and how many world steps it takes; empty where it cannot be made.
static size_t search(const Scenario *scenario, double target, double dear_s, char words[256])
{
    Scheme schemes[SCHEME_MAX];
    size_t count = scheme_list(scenario, schemes);
    scheme_keep_usual(schemes, &count);
    Tune *tune = tune_create(scenario, schemes, count, target);
    tune->cost = TUNE_STEPS;
    tune->dear_s = dear_s;
    const TuneSearch search = {.tune = tune,
                               .scenario = scenario,
                               .jobs = 1,
                               .time_limit_s = TIME_LIMIT_S,
                               .wait = wait_for_nothing};
    Err err = {ERR_NONE, ""};
    size_t steps = 0;
    words[0] = '\0';
    if (tune_search_execute(&search, &err)) {
        const int found[] = {tune->winner, tune->plain};
        for (size_t i = 0; i < 2; i++) {
            const TuneTrial *best = tune_best(tune, found[i]);
            snprintf(words + strlen(words), 256 - strlen(words), "%s %g us, ",
                     best != NULL ? tune->schemes[best->scheme].scheme.name : "none",
                     best != NULL ? 1e6 * best->value : 0.0);
        }
    }
    for (size_t i = 0; i < tune->trial_count; i++) {
        steps += tune->trials[i].run.steps;
    }
    tune_destroy(tune);
    return steps;
}

static size_t compare_searches(const CaseKind *kind, uint64_t seed, const Scenario *scenario,
                               bool is_flawed)
{
    size_t differing = 0;
    for (size_t i = 0; i < sizeof TARGETS / sizeof TARGETS[0]; i++) {
        char whole[256];
        char part[256];
        const size_t steps = search(scenario, TARGETS[i], INFINITY, whole);
        const size_t fewer = search(scenario, (is_flawed ? 0.5 : 1.0) * TARGETS[i], 0.0, part);
        const bool is_equal = strcmp(whole, part) == 0;
        differing += is_equal ? 0 : 1;
        printf("%s %llu tune %g: %s%zu steps for %zu%s%s\n", kind->name, (unsigned long long)seed,
               TARGETS[i], whole, fewer, steps,
               is_equal ? "" : ": DIFFERS: ", is_equal ? "" : part);
    }
    return differing;
}

int main(int argc, char **argv)
{
    const CaseKind *kind = NULL;
    for (size_t i = 0; argc > 3 && i < sizeof KINDS / sizeof KINDS[0]; i++) {
        kind = strcmp(argv[1], KINDS[i]->name) == 0 ? KINDS[i] : kind;
    }
    if (kind == NULL) {
        fprintf(stderr, "usage: left_out KIND FIRST LAST [flaw]\n");
        return 2;
    }
    const bool is_flawed = argc > 4 && strcmp(argv[4], "flaw") == 0;
    size_t wrong = 0;
    const uint64_t last = strtoull(argv[3], NULL, 10);
    for (uint64_t seed = strtoull(argv[2], NULL, 10); seed <= last; seed++) {
        Scenario *scenario = calloc(1, sizeof *scenario);
        assert(scenario != NULL);
        if (load(kind, seed, scenario)) {
            Truth truth = truth_make(scenario, (RunWatch){NULL, NULL});
            if (truth.trajectory != NULL && truth.message[0] == '\0') {
                const Found found = compare_ladders(scenario, &truth, is_flawed);
                printf("%s %llu compare: %zu of %zu points left out, %zu wrongly\n", kind->name,
                       (unsigned long long)seed, found.left_out, found.points, found.wrong);
                wrong += found.wrong + compare_searches(kind, seed, scenario, is_flawed);
            }
            truth_finish(&truth);
        }
        scenario_destroy(scenario);
        fflush(stdout);
    }
    return wrong > 0 ? 1 : 0;
}

// Is the error of a run that of the whole motion, and the reference's uncertainty honest?
//
// whole_motion KIND FIRST LAST
// Runs the random cases of those seeds in the plane, cut to a tenth of a turn or 0.05 s, and judges
// the reference and runs at `step: auto` by an integration in other coordinates (maximal.h), made
// at two tolerances: their difference is what the judge does not know. Violations are a reference
// further off than three times its uncertainty, and a run above its tolerance where it says that it
// holds. Exit status 1 where there is any.
//
// whole_motion --control KIND SEED
// The same case judged under 0.1 % more gravity: exit status 0 where that is seen.
#include "random_scenario.h"

#include "maximal.h"

#include "measure/child.h"
#include "measure/chosen_run.h"

#include <stdlib.h>
#include <string.h>

enum { TOLERANCE_COUNT = 3 };

static const double TOLERANCES[TOLERANCE_COUNT] = {1e-3, 1e-4, 1e-6};
static const double JUDGE_TOLERANCES[2] = {1e-13, 1e-14};
static const double HONEST = 3.0; // of the uncertainty

// What the judge does not know: of the difference of its two runs, whose tolerances are ten times
// apart, a tenth where its error follows the tolerance, here three times that.
static const double JUDGE_UNKNOWN = 0.3;
static const double JUDGE_SHARE = 0.5; // of the uncertainty, or a tolerance, that this may be
static const double CONTROL_GRAVITY = 1.001;
static const double TIME_LIMIT_S = 40.0; // of one case

static const CaseKind *const KINDS[] = {&CASE_FOUR_BAR, &CASE_BODIES,   &CASE_SPRUNG,
                                        &CASE_SLIDERS,  &CASE_BALLS,    &CASE_LIMITS,
                                        &CASE_PENDULA,  &CASE_FOUR_BARS};

typedef struct Result {
    char message[160]; // why the case could not be judged
    bool is_blunt;     // the judge is not sharp enough for the uncertainty
    bool is_dishonest;
    double uncertainty;
    double off; // of the reference from the judge
    double unknown;
    int runs;
    int runs_judged;
    double errors[TOLERANCE_COUNT]; // against the judge; NAN where the run failed
    int above;
} Result;

typedef struct Work {
    const CaseKind *kind;
    uint64_t seed;
    MaximalFlaw flaw;
} Work;

static void judge_runs(Scenario *scenario, const Truth *truth, const Trajectory *judge,
                       double horizon_s, Result *result)
{
    for (int i = 0; i < TOLERANCE_COUNT; i++) {
        scenario->run.tolerance = TOLERANCES[i];
        Trajectory *run = chosen_run_make(scenario, truth, (ChosenWatch){.begin = NULL}, NULL);
        result->errors[i] = NAN;
        if (run->is_complete) {
            result->runs++;
            result->errors[i] =
                apart_until(run, judge, truth->trajectory, fmin(horizon_s, run->estimate_s));
            const bool is_sharp = result->unknown / JUDGE_UNKNOWN <= JUDGE_SHARE * TOLERANCES[i];
            result->runs_judged += is_sharp ? 1 : 0;
            result->above +=
                !is_sharp || result->errors[i] <= TOLERANCES[i] + result->unknown ? 0 : 1;
        }
        trajectory_destroy(run);
    }
}

static void measure(const void *context, void *target)
{
    static const char *const CUT[] = {"run.step=auto", "run.most-steps=300000"};
    const Work *work = context;
    Result *result = target;
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    memset(result, 0, sizeof *result);
    if (!random_scenario(work->kind, work->seed, CUT, 2, &scenario, &err)) {
        snprintf(result->message, sizeof result->message, "%.150s", err.text);
        return;
    }
    scenario.run.revolutions = fmin(scenario.run.revolutions, 0.1);
    if (!scenario.linkage.driver.is_present) {
        scenario.run.duration = fmin(scenario.run.duration, 0.05);
    }
    Truth truth = truth_make(&scenario, (RunWatch){NULL, NULL});
    Trajectory *rough = maximal_run(&scenario, &work->flaw, JUDGE_TOLERANCES[0]);
    Trajectory *judge = maximal_run(&scenario, &work->flaw, JUDGE_TOLERANCES[1]);
    if (!truth.trajectory->is_complete || !rough->is_complete || !judge->is_complete) {
        snprintf(result->message, sizeof result->message, "%.70s; %.70s", truth.trajectory->message,
                 judge->message);
    } else {
        const double horizon_s = truth.is_limited ? truth.horizon_s : scenario_duration(&scenario);
        result->uncertainty = truth.uncertainty;
        result->off = apart_until(truth.trajectory, judge, truth.trajectory, horizon_s);
        result->unknown = JUDGE_UNKNOWN * apart_until(rough, judge, truth.trajectory, horizon_s);
        result->is_blunt = !(result->unknown <= JUDGE_SHARE * truth.uncertainty);
        result->is_dishonest = !(truth.uncertainty > 0.0) ||
                               (!result->is_blunt && !(result->off <= HONEST * truth.uncertainty));
        judge_runs(&scenario, &truth, judge, horizon_s, result);
    }
    trajectory_destroy(rough);
    trajectory_destroy(judge);
    truth_finish(&truth);
    scenario_free(&scenario);
}

static bool run_case(const Work *work, Result *result)
{
    Child child = {0};
    Err err = {ERR_NONE, ""};
    const ChildLimits limits = {.time_s = TIME_LIMIT_S, .memory_bytes = (size_t)4 << 30};
    if (!child_start(&child, measure, work, result, sizeof *result, limits, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return false;
    }
    while (child.end == CHILD_RUNNING) {
        child_wait(&child, 1, 1.0);
    }
    if (child.end != CHILD_DONE) {
        char words[CHILD_TEXT_SIZE];
        child_describe(&child, words);
        memset(result, 0, sizeof *result);
        snprintf(result->message, sizeof result->message, "its process %.100s", words);
    }
    printf("%s %llu: %s uncertainty %.2g, reference off %.2g, judge %.1g%s%s; errors %.2g %.2g "
           "%.2g%s\n",
           work->kind->name, (unsigned long long)work->seed, result->message, result->uncertainty,
           result->off, result->unknown, result->is_blunt ? " (blunt)" : "",
           result->is_dishonest ? " DISHONEST" : "", result->errors[0], result->errors[1],
           result->errors[2], result->above > 0 ? " ABOVE" : "");
    fflush(stdout);
    return true;
}

static const CaseKind *kind_of(const char *name)
{
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
        if (strcmp(KINDS[i]->name, name) == 0) {
            return KINDS[i];
        }
    }
    return NULL;
}

int main(int argc, char **argv)
{
    const bool is_control = argc == 4 && strcmp(argv[1], "--control") == 0;
    const CaseKind *kind = argc == 4 ? kind_of(argv[is_control ? 2 : 1]) : NULL;
    if (kind == NULL) {
        fprintf(stderr, "usage: whole_motion KIND FIRST LAST | whole_motion --control KIND SEED\n");
        return 2;
    }
    const uint64_t first = strtoull(argv[is_control ? 3 : 2], NULL, 10);
    const uint64_t last = strtoull(argv[3], NULL, 10);
    int cases = 0;
    int unjudged = 0;
    int blunt = 0;
    int dishonest = 0;
    int runs = 0;
    int runs_judged = 0;
    int above = 0;
    for (uint64_t seed = first; seed <= last; seed++) {
        const Work work = {kind, seed, {is_control ? CONTROL_GRAVITY : 1.0, 1.0}};
        Result result;
        if (!run_case(&work, &result)) {
            return 4;
        }
        cases++;
        unjudged += result.message[0] != '\0' ? 1 : 0;
        blunt += result.is_blunt ? 1 : 0;
        dishonest += result.is_dishonest ? 1 : 0;
        runs += result.runs;
        runs_judged += result.runs_judged;
        above += result.above;
    }
    printf("%s: cases %d, not judged %d, judge too blunt %d, dishonest %d; runs %d, of which "
           "judged %d, above their tolerance %d\n",
           kind->name, cases, unjudged, blunt, dishonest, runs, runs_judged, above);
    return (dishonest + above > 0) != is_control ? 1 : 0;
}

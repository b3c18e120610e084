// Is the error of a run that of the whole motion, and the reference's uncertainty honest?
//
// whole_motion KIND FIRST LAST
// Runs the random cases of those seeds, cut to a tenth of a turn or 0.05 s, and judges the
// reference and runs at `step: auto`, up to the horizon, by an integration in other coordinates
// (maximal.h), made at two tolerances: their difference is what the judge does not know. Where that
// is too much for the uncertainty the judge is made sharper, down to 1e-16 and with shorter steps;
// if it is still too blunt, what it does not know is allowed too. Violations are a reference
// further off than three times its uncertainty, and a run above its tolerance where it says that it
// holds. Exit status 1 where there is any. What a sweep found stands in docs/stepping.md.
//
// whole_motion --control KIND SEED
// The same case judged under 0.1 % more gravity, with a first body that is 0.1 % heavier: exit
// status 0 where that is seen.
//
// whole_motion --case FILE TOLERANCE...
// A case of one's own, up to its horizon, at one to three tolerances.
#include "random_scenario.h"

#include "maximal.h"

#include "casefile/casefile.h"
#include "measure/child.h"
#include "measure/chosen_run.h"

#include <stdlib.h>
#include <string.h>

enum { TOLERANCE_COUNT = 3 };

static const double TOLERANCES[TOLERANCE_COUNT] = {1e-3, 1e-4, 1e-6};

// a judge that is too blunt is followed by a sharper one
enum { JUDGE_COUNT = 4 };
static const double JUDGE_TOLERANCES[JUDGE_COUNT] = {1e-13, 1e-14, 1e-15, 1e-16};
static const double JUDGE_STEPS[JUDGE_COUNT] = {2e4, 2e4, 1e5, 3e5};
static const double HONEST = 3.0; // of the uncertainty

// What the judge does not know: of the difference of its two runs, whose tolerances are ten times
// apart, a tenth where its error follows the tolerance, here three times that.
static const double JUDGE_UNKNOWN = 0.3;
static const double JUDGE_UNSURE = 10.0; // of a blunt judge: three of its differences
static const double JUDGE_SHARE = 0.5;   // of the uncertainty, or a tolerance, that this may be
static const double CONTROL_FLAW = 1.001;
static const double TIME_LIMIT_S = 400.0; // of one case, on a busy machine
static const double OWN_TIME_LIMIT_S = 600.0;

static const CaseKind *const KINDS[] = {
    &CASE_FOUR_BAR, &CASE_BODIES,       &CASE_SPRUNG,    &CASE_SLIDERS, &CASE_BALLS,
    &CASE_LIMITS,   &CASE_PENDULA,      &CASE_FOUR_BARS, &CASE_HOLES,   &CASE_ROTORS,
    &CASE_RACKS,    &CASE_GEARS,        &CASE_CAMS,      &CASE_SLOTS,   &CASE_RUN_UPS,
    &CASE_SPACE,    &CASE_SPACE_DRIVEN, &CASE_GROWING,   &CASE_SERVOS};

typedef struct Result {
    char message[160]; // why the case could not be judged
    bool is_blunt;     // the judge is not sharp enough for the uncertainty
    bool is_dishonest;
    double uncertainty;
    double off; // of the reference from the judge
    double unknown;
    double horizon_s;
    int runs;
    int runs_judged;
    double errors[TOLERANCE_COUNT]; // against the judge; NAN where the run failed
    int above;
} Result;

typedef struct Work {
    const char *path; // of a case, or NULL
    const CaseKind *kind;
    uint64_t seed;
    MaximalFlaw flaw;
    int tolerance_count;
    double tolerances[TOLERANCE_COUNT];
    double time_limit_s;
} Work;

static void judge_runs(const Work *work, Scenario *scenario, const Truth *truth,
                       const Trajectory *judge, Result *result)
{
    for (int i = 0; i < work->tolerance_count; i++) {
        const double tolerance = work->tolerances[i];
        scenario->run.tolerance = tolerance;
        Trajectory *run =
            backend_run(scenario, BACKEND_ODE, truth, (ChosenWatch){.begin = NULL}, NULL);
        result->errors[i] = NAN;
        if (run->is_complete) {
            result->runs++;
            result->errors[i] = apart_until(run, judge, truth->trajectory,
                                            fmin(result->horizon_s, run->estimate_s));
            const bool is_sharp = result->unknown / JUDGE_UNKNOWN <= JUDGE_SHARE * tolerance;
            result->runs_judged += is_sharp ? 1 : 0;
            result->above += !is_sharp || result->errors[i] <= tolerance + result->unknown ? 0 : 1;
        }
        trajectory_destroy(run);
    }
}

// The motion by a judge that is sharp enough for the uncertainty, or the sharpest, and what it says
// of the reference; a message where there is none.
static Trajectory *sharp_judge(const Work *work, const Scenario *scenario, const Truth *truth,
                               Result *result)
{
    const double until_s = truth->is_limited ? truth->horizon_s : scenario_duration(scenario);
    Trajectory *judge =
        maximal_run(scenario, &work->flaw, JUDGE_TOLERANCES[0], JUDGE_STEPS[0], until_s);
    result->horizon_s = until_s;
    result->uncertainty = truth->uncertainty;
    result->is_blunt = true;
    for (int i = 1; i < JUDGE_COUNT && result->is_blunt; i++) {
        Trajectory *next =
            maximal_run(scenario, &work->flaw, JUDGE_TOLERANCES[i], JUDGE_STEPS[i], until_s);
        if (!judge->is_complete || !next->is_complete) {
            // the sharpest ones end by rounding: then the one before them judges
            if (i == 1) {
                snprintf(result->message, sizeof result->message, "%.70s; %.70s", judge->message,
                         next->message);
            }
            trajectory_destroy(next);
            break;
        }
        const double apart = apart_until(judge, next, truth->trajectory, result->horizon_s);
        trajectory_destroy(judge);
        judge = next;
        result->unknown = JUDGE_UNKNOWN * apart;
        result->is_blunt = !(result->unknown <= JUDGE_SHARE * truth->uncertainty);
    }
    if (result->message[0] != '\0') {
        return judge;
    }
    result->off = apart_until(truth->trajectory, judge, truth->trajectory, result->horizon_s);
    const double allowed =
        HONEST * truth->uncertainty + (result->is_blunt ? JUDGE_UNSURE * result->unknown : 0.0);
    result->is_dishonest = !(truth->uncertainty > 0.0) || !(result->off <= allowed);
    return judge;
}

static void measure(const void *context, void *target)
{
    static const char *const CUT[] = {"run.step=auto", "run.most-steps=300000"};
    const Work *work = context;
    Result *result = target;
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    memset(result, 0, sizeof *result);
    const bool is_loaded = work->path != NULL
                               ? casefile_load(work->path, CUT, 2, &scenario, &err)
                               : random_scenario(work->kind, work->seed, CUT, 2, &scenario, &err);
    if (!is_loaded) {
        snprintf(result->message, sizeof result->message, "%.150s", err.text);
        return;
    }
    if (work->path == NULL) {
        scenario.run.revolutions = fmin(scenario.run.revolutions, 0.1);
        if (!drive_is_steady(&scenario.linkage.driver)) {
            scenario.run.duration = fmin(scenario.run.duration, 0.05);
        }
    }
    Truth truth = truth_make(&scenario, (RunWatch){NULL, NULL});
    if (!truth.trajectory->is_complete) {
        snprintf(result->message, sizeof result->message, "%.150s", truth.trajectory->message);
    } else {
        Trajectory *judge = sharp_judge(work, &scenario, &truth, result);
        if (result->message[0] == '\0') {
            judge_runs(work, &scenario, &truth, judge, result);
        }
        trajectory_destroy(judge);
    }
    truth_finish(&truth);
    scenario_free(&scenario);
}

static bool run_case(const Work *work, Result *result)
{
    Child child = {0};
    Err err = {ERR_NONE, ""};
    const ChildLimits limits = {.time_s = work->time_limit_s, .memory_bytes = (size_t)4 << 30};
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
    printf("%s %llu: %s horizon %.4g ms, uncertainty %.2g, reference off %.2g, judge %.1g%s%s; "
           "errors",
           work->path != NULL ? work->path : work->kind->name, (unsigned long long)work->seed,
           result->message, 1e3 * result->horizon_s, result->uncertainty, result->off,
           result->unknown, result->is_blunt ? " (blunt)" : "",
           result->is_dishonest ? " DISHONEST" : "");
    for (int i = 0; i < work->tolerance_count; i++) {
        printf(" %.2g", result->errors[i]);
    }
    printf("%s\n", result->above > 0 ? " ABOVE" : "");
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

// What all cases of a call come to.
typedef struct Sum {
    int cases;
    int unjudged;
    int blunt;
    int dishonest;
    int runs;
    int runs_judged;
    int above;
} Sum;

static void add_result(const Result *result, Sum *sum)
{
    sum->cases++;
    sum->unjudged += result->message[0] != '\0' ? 1 : 0;
    sum->blunt += result->is_blunt ? 1 : 0;
    sum->dishonest += result->is_dishonest ? 1 : 0;
    sum->runs += result->runs;
    sum->runs_judged += result->runs_judged;
    sum->above += result->above;
}

static int conclude(const char *name, const Sum *sum, bool is_control)
{
    printf("%s: cases %d, not judged %d, judge too blunt %d, dishonest %d; runs %d, of which "
           "judged %d, above their tolerance %d\n",
           name, sum->cases, sum->unjudged, sum->blunt, sum->dishonest, sum->runs, sum->runs_judged,
           sum->above);
    return (sum->dishonest + sum->above > 0) != is_control ? 1 : 0;
}

static int usage(void)
{
    fprintf(stderr, "usage: whole_motion KIND FIRST LAST | whole_motion --control KIND SEED |\n"
                    "       whole_motion --case FILE TOLERANCE [TOLERANCE [TOLERANCE]]\n");
    return 2;
}

static int judge_case(int argc, char **argv)
{
    Work work = {.path = argv[2],
                 .flaw = MAXIMAL_RIGHT,
                 .tolerance_count = argc - 3,
                 .time_limit_s = OWN_TIME_LIMIT_S};
    Result result;
    Sum sum = {0};
    for (int i = 3; i < argc; i++) {
        work.tolerances[i - 3] = strtod(argv[i], NULL);
    }
    if (!run_case(&work, &result)) {
        return 4;
    }
    add_result(&result, &sum);
    return conclude(work.path, &sum, false);
}

int main(int argc, char **argv)
{
    if (argc >= 4 && argc <= 3 + TOLERANCE_COUNT && strcmp(argv[1], "--case") == 0) {
        return judge_case(argc, argv);
    }
    const bool is_control = argc == 4 && strcmp(argv[1], "--control") == 0;
    const CaseKind *kind = argc == 4 ? kind_of(argv[is_control ? 2 : 1]) : NULL;
    if (kind == NULL) {
        return usage();
    }
    const uint64_t last = strtoull(argv[3], NULL, 10);
    Work work = {.kind = kind,
                 .flaw = is_control ? (MaximalFlaw){CONTROL_FLAW, CONTROL_FLAW} : MAXIMAL_RIGHT,
                 .tolerance_count = TOLERANCE_COUNT,
                 .time_limit_s = TIME_LIMIT_S};
    Sum sum = {0};
    memcpy(work.tolerances, TOLERANCES, sizeof TOLERANCES);
    for (work.seed = strtoull(argv[is_control ? 3 : 2], NULL, 10); work.seed <= last; work.seed++) {
        Result result;
        if (!run_case(&work, &result)) {
            return 4;
        }
        add_result(&result, &sum);
    }
    return conclude(kind->name, &sum, is_control);
}

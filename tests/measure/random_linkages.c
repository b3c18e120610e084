// Is any run of a random linkage wrong without a word? Runs seeded cases of every kind through the
// closed form, the reference and ODE, for a short time each, and counts how they end.
//
// random_linkages FIRST LAST [SECONDS [KIND]]
//   FIRST LAST  seeds; the kind of mechanism and the scheme of ODE follow from the seed
//   SECONDS     of the clock that one linkage may take (default 10)
//   KIND        of mechanism, of which all are then; seeds count these alone
// Outcomes:
//   refused   the case file, or the solver before its first step, says what is not allowed
//   agrees    the error is below a limit: of the closed form and the reference AGREES_EXACT or
//             three times what the reference states, of ODE at a fixed step AGREES_STEP, at `step:
//             auto` its tolerance
//   reported  the error is above it, and the run prints it: ODE at a fixed step beside the
//             reference, `step: auto` that ran out of steps, a reference that is not certified
//   detected  the run ends with a sentence
//   slow      the time was up
//   SILENT    anything else: numbers that are wrong or not finite in a run that says nothing, or a
//             process that dies
// Each SILENT one is printed with its seed and kind; status 1 where there is one.
#include "random_draw.h"
#include "random_scenario.h"

#include "../support/kept.h"
#include "casefile/casefile.h"
#include "measure/child.h"
#include "measure/chosen_run.h"
#include "measure/error.h"
#include "run/registry.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

typedef enum Outcome {
    NONE, // does not apply
    REFUSED,
    AGREES,
    REPORTED,
    DETECTED,
    SLOW,
    SILENT,
    OUTCOME_TOTAL,
} Outcome;

typedef enum Part { CASE, CLOSED_FORM, REFERENCE, ODE_FIXED, ODE_AUTO, PART_TOTAL } Part;

static const char *const OUTCOME_NAMES[] = {"-",        "refused", "agrees", "reported",
                                            "detected", "slow",    "SILENT"};
static const char *const PART_NAMES[] = {"case file", "closed form", "reference", "ode, fixed step",
                                         "ode, auto"};

static const CaseKind *const KINDS[] = {&CASE_FOUR_BAR,  &CASE_BODIES,     &CASE_PENDULA,
                                        &CASE_FOUR_BARS, &CASE_LOCK,       &CASE_CHANGE_POINT,
                                        &CASE_TOUCHING,  &CASE_SEPARATING, &CASE_SPRUNG,
                                        &CASE_SLIDERS,   &CASE_BALLS,      &CASE_LIMITS};

// every way of stepping ODE; the others' keys are the case's own
static const char *const SCHEMES[][2] = {
    {"ode.stepping=plain", "ode.map=textbook"},     {"ode.stepping=staggered", "ode.map=midpoint"},
    {"ode.stepping=staggered", "ode.map=exact"},    {"ode.stepping=staggered", "ode.map=impulse"},
    {"ode.stepping=staggered", "ode.map=textbook"}, {"ode.stepping=plain", "ode.solver=quick"},
};

enum { KIND_TOTAL = sizeof KINDS / sizeof *KINDS, SCHEME_TOTAL = sizeof SCHEMES / sizeof *SCHEMES };

static const double TURNS = 0.02;    // of a drive
static const double LENGTH_S = 2e-3; // without one
static const double AGREES_EXACT = 1e-9;
static const double AGREES_STEP = 1e-3;
static const double TOLERANCE = 1e-4; // of `step: auto`
static const double STEPS = 400.0;    // at most, of a fixed step
static const char MOST_STEPS[] = "run.most-steps=8000";

typedef struct Result {
    Outcome outcomes[PART_TOTAL];
    char words[PART_TOTAL][160];
} Result;

static void tell(Result *result, Part part, Outcome outcome, const char *words, double number)
{
    result->outcomes[part] = outcome;
    snprintf(result->words[part], sizeof result->words[part], "%.130s %.3g", words, number);
}

static bool load(uint64_t seed, Draw *draw, Scenario *scenario, Err *err)
{
    const char *const *scheme = SCHEMES[draw_below(draw, SCHEME_TOTAL)];
    const char *const settings[] = {scheme[0], scheme[1], MOST_STEPS};
    const bool is_loaded =
        random_scenario(KINDS[seed % KIND_TOTAL], seed / KIND_TOTAL, settings, 3, scenario, err);
    scenario->run.revolutions = fmin(scenario->run.revolutions, TURNS);
    scenario->run.duration = fmin(scenario->run.duration, LENGTH_S);
    // of a drive counted a turn
    scenario->run.samples = scenario->linkage.driver.is_present ? (size_t)(40.0 / TURNS) : 40;
    scenario->run.report_from = 0.0;
    return is_loaded;
}

static bool is_finite(const Trajectory *run)
{
    for (size_t k = 0; k < run->sample_count; k++) {
        for (size_t i = 0; i < run->body_count; i++) {
            const Motion *motion = trajectory_motion(run, k, i);
            if (!isfinite(motion->omega + motion->angle + motion->position.x)) {
                return false;
            }
        }
    }
    return true;
}

static double horizon_of(const Truth *truth)
{
    return truth->is_limited ? truth->horizon_s : INFINITY;
}

static void judge_reference(const Scenario *scenario, const Truth *truth, Result *result)
{
    const Trajectory *run = truth->trajectory;
    if (!run->is_complete) {
        tell(result, REFERENCE, run->steps == 0 ? REFUSED : DETECTED, run->message, 0.0);
        return;
    }
    const Scenario other = moved_scenario(scenario, 1e-14);
    Trajectory *judge =
        run_scenario(&other, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
    if (!is_finite(run)) {
        tell(result, REFERENCE, SILENT, "not finite", 0.0);
    } else if (!judge->is_complete) {
        tell(result, REFERENCE, DETECTED, judge->message, 0.0);
    } else {
        const double error = error_against(run, judge, horizon_of(truth)).omega_max_in_horizon;
        const bool is_reported = truth->message[0] != '\0' || isnan(error);
        const bool agrees = error <= fmax(AGREES_EXACT, 3.0 * truth->uncertainty);
        tell(result, REFERENCE, agrees ? AGREES : is_reported ? REPORTED : SILENT, "error", error);
    }
    trajectory_destroy(judge);
}

// The closed form of a four-bar against the reference, with its joints ideal. A pin that starts off
// the centre of its hole has moved the bodies: then the start would be another.
static void judge_closed_form(const Scenario *scenario, Result *result)
{
    Scenario ideal = kept_copy(scenario);
    for (size_t i = 0; i < ideal.linkage.joint_count; i++) {
        Joint *joint = &ideal.linkage.joints[i];
        if (joint->kind == JOINT_CLEARANCE && vec2_length(joint->clearance.start) > 0.0) {
            return;
        }
        joint->kind = JOINT_REVOLUTE;
    }
    if (!ideal.has_fourbar) {
        return;
    }
    Trajectory *closed =
        run_scenario(&ideal, registry_solver(BACKEND_ANALYTIC), (RunWatch){NULL, NULL});
    Trajectory *reference =
        run_scenario(&ideal, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
    if (!closed->is_complete || !reference->is_complete) {
        tell(result, CLOSED_FORM, DETECTED,
             closed->is_complete ? reference->message : closed->message, 0.0);
    } else {
        const double error = error_against(reference, closed, INFINITY).omega_max;
        tell(result, CLOSED_FORM, error <= AGREES_EXACT ? AGREES : SILENT, "error", error);
    }
    trajectory_destroy(closed);
    trajectory_destroy(reference);
}

static void judge_fixed(Scenario scenario, Draw *draw, const Truth *truth, Result *result)
{
    const double duration_s = scenario_duration(&scenario);
    scenario.run.step = duration_s / draw_log_between(draw, 10.0, STEPS);
    scenario.run.tolerance = 0.0;
    Trajectory *run = run_scenario(&scenario, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
    if (!run->is_complete) {
        tell(result, ODE_FIXED, run->steps == 0 ? REFUSED : DETECTED, run->message, 0.0);
    } else if (!is_finite(run)) {
        tell(result, ODE_FIXED, SILENT, "not finite", 0.0);
    } else if (!truth->trajectory->is_complete) {
        tell(result, ODE_FIXED, REPORTED, "its error is not known", 0.0);
    } else {
        const TrajectoryError error = error_against(run, truth->trajectory, horizon_of(truth));
        const bool agrees = error.omega_max_in_horizon <= AGREES_STEP;
        tell(result, ODE_FIXED, agrees ? AGREES : REPORTED, "error", error.omega_max_in_horizon);
    }
    trajectory_destroy(run);
}

static void judge_auto(Scenario scenario, const Truth *truth, Result *result)
{
    scenario.run.tolerance = TOLERANCE;
    Trajectory *run =
        backend_run(&scenario, BACKEND_ODE, truth, (ChosenWatch){.begin = NULL}, NULL);
    if (!run->is_complete) {
        tell(result, ODE_AUTO, DETECTED, run->message, 0.0);
    } else {
        const double error =
            error_against(run, truth->trajectory, run->estimate_s).omega_max_in_horizon;
        const bool is_bounded = is_finite(run) && !(error > run->error_estimate);
        const bool holds = is_bounded && !(error > TOLERANCE);
        tell(result, ODE_AUTO,
             holds && !run->is_short ? AGREES
             : is_bounded            ? REPORTED
                                     : SILENT,
             "error", error);
    }
    trajectory_destroy(run);
}

static void measure(const void *context, void *target)
{
    const uint64_t seed = *(const uint64_t *)context;
    Result *result = target;
    static Scenario scenario; // too large for the stack
    Err err = {ERR_NONE, ""};
    Draw draw = draw_start(seed ^ 0x5eedu);
    memset(result, 0, sizeof *result);
    if (!load(seed, &draw, &scenario, &err)) {
        tell(result, CASE, REFUSED, err.text, 0.0);
        return;
    }
    result->outcomes[CASE] = AGREES;
    judge_closed_form(&scenario, result);
    Truth truth = truth_make(&scenario, (RunWatch){NULL, NULL});
    judge_reference(&scenario, &truth, result);
    judge_fixed(scenario, &draw, &truth, result);
    judge_auto(scenario, &truth, result);
    truth_finish(&truth);
}

// Runs one linkage in a process of its own.
static void run_linkage(uint64_t seed, double time_limit_s, Result *result)
{
    Child child = {0};
    Err err = {ERR_NONE, ""};
    const ChildLimits limits = {.time_s = time_limit_s, .memory_bytes = (size_t)4 << 30};
    if (!child_start(&child, measure, &seed, result, sizeof *result, limits, &err)) {
        fprintf(stderr, "%s\n", err.text);
        exit(4);
    }
    while (child.end == CHILD_RUNNING) {
        child_wait(&child, 1, 1.0);
    }
    if (child.end != CHILD_DONE) {
        char words[CHILD_TEXT_SIZE];
        child_describe(&child, words);
        memset(result, 0, sizeof *result);
        tell(result, CASE, child.end == CHILD_TIMED_OUT ? SLOW : SILENT, words, 0.0);
    }
}

static void print_counts(size_t counts[PART_TOTAL][OUTCOME_TOTAL])
{
    printf("%-16s", "");
    for (int outcome = REFUSED; outcome < OUTCOME_TOTAL; outcome++) {
        printf(" %9s", OUTCOME_NAMES[outcome]);
    }
    printf("\n");
    for (int part = 0; part < PART_TOTAL; part++) {
        printf("%-16s", PART_NAMES[part]);
        for (int outcome = REFUSED; outcome < OUTCOME_TOTAL; outcome++) {
            printf(" %9zu", counts[part][outcome]);
        }
        printf("\n");
    }
}

// The number of a kind; all of them where there is none of that name.
static size_t find_kind(const char *name)
{
    size_t kind = 0;
    while (kind < KIND_TOTAL && strcmp(KINDS[kind]->name, name) != 0) {
        kind++;
    }
    return kind;
}

int main(int argc, char **argv)
{
    const size_t kind = argc > 4 ? find_kind(argv[4]) : 0;
    if (argc < 3 || kind == KIND_TOTAL) {
        fprintf(stderr, "usage: random_linkages FIRST LAST [SECONDS [KIND]]\n");
        return 2;
    }
    const uint64_t first = strtoull(argv[1], NULL, 10);
    const uint64_t last = strtoull(argv[2], NULL, 10);
    const double time_limit_s = argc > 3 ? strtod(argv[3], NULL) : 10.0;
    const bool is_loud = getenv("ALL") != NULL;
    static size_t counts[PART_TOTAL][OUTCOME_TOTAL];
    bool is_silent = false;
    for (uint64_t number = first; number <= last; number++) {
        const uint64_t seed = argc > 4 ? KIND_TOTAL * number + kind : number;
        Result result;
        run_linkage(seed, time_limit_s, &result);
        for (int part = 0; part < PART_TOTAL; part++) {
            const Outcome outcome = result.outcomes[part];
            counts[part][outcome]++;
            is_silent = is_silent || outcome == SILENT;
            if (outcome == SILENT || outcome == SLOW || (is_loud && outcome != NONE)) {
                printf("%llu (%s %llu) %s: %s: %s\n", (unsigned long long)seed,
                       KINDS[seed % KIND_TOTAL]->name, (unsigned long long)(seed / KIND_TOTAL),
                       PART_NAMES[part], OUTCOME_NAMES[outcome], result.words[part]);
                fflush(stdout);
            }
        }
    }
    print_counts(counts);
    return is_silent ? 1 : 0;
}

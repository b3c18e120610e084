// Do answers depend on how a mechanism is written, or on a pivot far away?
//
// invariance [SEED [MEMBERS]] (1, 24): a slider-crank whose slider is the end of a rocker of 1 to
// 1000 m, with the uncertainty of its truth, the reference's evaluations, and of starts a
// thousandth beside the medians of horizons, forces and impulses with their standard errors; and
// the same mechanism written in five ways, with the largest relative difference of the truths up to
// the horizon, and of the values and floors of `check`. The seed is that of the ensembles. Two
// minutes of one processor at most.
#include "rocker.h"
#include "starts.h"

#include "../support/kept.h"
#include "commands/check/check_measure.h"
#include "measure/error.h"
#include "model/kinematics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_SEED = 1, DEFAULT_MEMBERS = 24, PIN = 2 };

static const RunWatch NOBODY = {NULL, NULL};
static const double PERTURBATION = 1e-3; // of ensembles
static const double STEP_S = 2e-6;       // of ODE
static const double TURNS = 3.0;         // in which horizons are looked for

typedef struct Answers {
    Truth truth;
    size_t evaluations;
    Median horizon; // s
    Median force;   // N, largest in the joint with play
    Median impulse; // N s
} Answers;

static Answers answer(const Scenario *scenario, unsigned seed, size_t members)
{
    Answers answers = {.truth = truth_make(scenario, NOBODY)};
    answers.evaluations = answers.truth.trajectory->evaluations;
    const Starts starts = {PERTURBATION, seed, members};
    PerturbUnit units[KINEMATICS_BODY_MAX];
    perturb_units(answers.truth.trajectory, units);
    Scenario longer = kept_copy(scenario);
    longer.run.revolutions = TURNS;
    answers.horizon = starts_horizon(&longer, units, starts);
    Scenario plain = kept_copy(scenario);
    plain.run.step = STEP_S;
    plain.run.samples = 360;
    starts_impact(&plain, units, starts, PIN, &answers.force, &answers.impulse);
    return answers;
}

static void print_answers(const char *name, const Answers *answers)
{
    printf("%-9s %7.3f %8.2g %7zu %6.2f +- %4.2f %6.2f +- %4.2f %6.2f +- %4.2f\n", name,
           1e3 * answers->truth.horizon_s, answers->truth.uncertainty, answers->evaluations,
           1e3 * answers->horizon.value, 1e3 * answers->horizon.error, 1e-3 * answers->force.value,
           1e-3 * answers->force.error, answers->impulse.value, answers->impulse.error);
    fflush(stdout);
}

static void print_heads(const char *name)
{
    printf("\n%-9s %7s %8s %7s %14s %14s %14s\n", name, "horizon", "uncert.", "evalu-",
           "median horizon", "force", "impulse");
    printf("%-9s %7s %8s %7s %14s %14s %14s\n", "", "ms", "1", "ations", "ms", "kN", "N s");
}

static void try_lengths(unsigned seed, size_t members)
{
    static const double LENGTHS[] = {1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0};
    print_heads("rocker");
    for (size_t i = 0; i < sizeof LENGTHS / sizeof *LENGTHS; i++) {
        char name[16];
        snprintf(name, sizeof name, "%g m", LENGTHS[i]);
        const Scenario scenario = rocker_make((RockerView){.length = LENGTHS[i]});
        Answers answers = answer(&scenario, seed, members);
        print_answers(name, &answers);
        truth_finish(&answers.truth);
    }
}

// Measures the case up to its horizon and to its end as `check` does.
static CheckMeasure *measure(const Scenario *scenario, const Truth *truth)
{
    CheckMeasure *made = calloc(1, sizeof *made);
    CheckPlan plan = check_plan(truth);
    plan.is_full = false;
    check_measure(scenario, &plan, made);
    if (!made->is_complete) {
        fprintf(stderr, "%s\n", made->message);
        exit(EXIT_FAILURE);
    }
    return made;
}

static double apart(double a, double b)
{
    const double larger = fmax(fabs(a), fabs(b));
    return larger > 0.0 ? fabs(a - b) / larger : 0.0;
}

// The largest differences of numbers up to the horizon, as shares of their scales, and of floors.
static void compare_measures(const CheckMeasure *one, const CheckMeasure *other, double *values,
                             double *floors)
{
    *values = *floors = one->count == other->count ? 0.0 : INFINITY;
    for (size_t i = 0; i < one->count && i < other->count; i++) {
        const CheckMetric *a = &one->metrics[i];
        const CheckMetric *b = &other->metrics[i];
        // what is relative to the truth's own rounding, work and hashes are not answers
        if (strstr(a->name, "-to-horizon/") == NULL || a->kind != CHECK_REAL ||
            strstr(a->name, "/error/") != NULL || strstr(a->name, "residual") != NULL ||
            !(a->scale > 0.0)) {
            continue;
        }
        *values = fmax(*values, fabs(a->value - b->value) / a->scale);
        *floors = fmax(*floors, apart(a->floor, b->floor));
    }
}

static void try_views(unsigned seed, size_t members)
{
    static const struct {
        const char *name;
        RockerView view;
    } VIEWS[] = {
        {"as it is", {.length = 1.0}},
        {"mm and g", {.length = 1.0, .in_millimetres = true}},
        {"turned", {.length = 1.0, .turn = 0.7}},
        {"shifted", {.length = 1.0, .shift = {0.3, -1.1}}},
        {"frames", {.length = 1.0, .frames = 0.4}},
    };
    enum { VIEW_COUNT = sizeof VIEWS / sizeof *VIEWS };
    Answers answers[VIEW_COUNT];
    CheckMeasure *measures[VIEW_COUNT];
    print_heads("written");
    for (size_t i = 0; i < VIEW_COUNT; i++) {
        const Scenario scenario = rocker_make(VIEWS[i].view);
        answers[i] = answer(&scenario, seed, members);
        print_answers(VIEWS[i].name, &answers[i]);
        Truth plan = answers[i].truth;
        plan.horizon_s = answers[0].truth.horizon_s;
        measures[i] = measure(&scenario, &plan);
    }
    printf("\n%-10s %14s %14s %14s\n%-10s %14s %14s %14s\n", "largest", "truth to", "check: values",
           "check:", "difference", "the horizon", "to the horizon", "floors");
    for (size_t i = 1; i < VIEW_COUNT; i++) {
        double values;
        double floors;
        const TrajectoryError error = error_against(
            answers[i].truth.trajectory, answers[0].truth.trajectory, answers[0].truth.horizon_s);
        compare_measures(measures[0], measures[i], &values, &floors);
        printf("%-10s %14.2g %14.2g %14.2g\n", VIEWS[i].name, error.omega_max_in_horizon, values,
               floors);
    }
    for (size_t i = 0; i < VIEW_COUNT; i++) {
        truth_finish(&answers[i].truth);
        free(measures[i]);
    }
}

int main(int argc, char **argv)
{
    const unsigned seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : DEFAULT_SEED;
    const size_t members = argc > 2 ? strtoul(argv[2], NULL, 10) : DEFAULT_MEMBERS;
    if (argc > 3 || seed == 0 || members < 2 || members > STARTS_MAX) {
        fprintf(stderr, "usage: invariance [SEED [MEMBERS]], MEMBERS from 2 to %d\n", STARTS_MAX);
        return 2;
    }
    try_lengths(seed, members);
    try_views(seed, members);
    return EXIT_SUCCESS;
}

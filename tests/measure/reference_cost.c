// What does the reference cost, at which error, and turn by turn?
//
// reference_cost errors CASE: evaluations of the equations of motion, steps, processor time and
// error of omega at a ladder of tolerances, against a run at the tightest.
// reference_cost turns CASE N [TOLERANCE]: evaluations, steps, contacts and time a turn in each
// tenth of N turns, without samples.
// reference_cost one CASE TOLERANCE: one run, to count its instructions; with its hash.
// reference_cost rates CASE: processor time of the equations of motion in the plane, by the short
// way of hinges and pins and by the long one, while all pins are apart and while all press.
#include "base/clock.h"
#include "casefile/casefile.h"
#include "measure/error.h"
#include "reference/plane/dynamics.h"
#include "reference/stepper.h"
#include "run/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const RunWatch NOBODY = {NULL, NULL};

static const double TIGHTEST = 1e-14;

enum { BLOCKS = 10 };

static Trajectory *run_at(const Scenario *scenario, double tolerance, double *spent_s)
{
    Scenario own = *scenario;
    own.reference.tolerance = tolerance;
    const double started_s = clock_processor_s();
    Trajectory *trajectory = run_scenario(&own, registry_solver(BACKEND_REFERENCE), NOBODY);
    *spent_s = clock_processor_s() - started_s;
    return trajectory;
}

static int try_errors(const Scenario *scenario)
{
    static const double TOLERANCES[] = {1e-2, 1e-3, 1e-4,  1e-5,  1e-6,  1e-7,
                                        1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 3e-13};
    double spent_s;
    Trajectory *truth = run_at(scenario, TIGHTEST, &spent_s);
    printf("%-9s %9s %8s %9s %9s\n", "tolerance", "evaluat.", "steps", "ms", "error");
    for (size_t i = 0; i < sizeof TOLERANCES / sizeof *TOLERANCES; i++) {
        Trajectory *run = run_at(scenario, TOLERANCES[i], &spent_s);
        double best_s = spent_s;
        for (int again = 0; again < 4; again++) {
            trajectory_destroy(run_at(scenario, TOLERANCES[i], &spent_s));
            best_s = spent_s < best_s ? spent_s : best_s;
        }
        const TrajectoryError error = error_against(run, truth, scenario_duration(scenario));
        printf("%-9.1e %9zu %8zu %9.3f %9.2e %s\n", TOLERANCES[i], run->evaluations, run->steps,
               1e3 * best_s, error.omega_max, run->message);
        fflush(stdout);
        trajectory_destroy(run);
    }
    trajectory_destroy(truth);
    return 0;
}

static int try_turns(Scenario *scenario, double turns, double tolerance)
{
    scenario->run.revolutions = turns;
    scenario->reference.tolerance = tolerance;
    Stepper *stepper = calloc(1, sizeof *stepper);
    Err err = {ERR_NONE, ""};
    bool is_well = stepper_init(stepper, scenario, &err);
    printf("%8s %9s %9s %9s %8s %9s\n", "turns", "evaluat.", "accepted", "rejected", "onsets", "s");
    printf("%8s %9s %9s %9s %8s %9s\n", "", "a turn", "a turn", "a turn", "a turn", "a turn");
    const double duration_s = scenario_duration(scenario);
    for (int block = 1; is_well && block <= BLOCKS; block++) {
        const size_t evaluations = stepper->integrator.evaluations;
        const size_t accepted = stepper->integrator.accepted;
        const size_t rejected = stepper->integrator.rejected;
        const double started_s = clock_processor_s();
        size_t onsets = 0;
        double time_s = 0.0;
        while (is_well && time_s < duration_s * block / BLOCKS * (1.0 - 1e-12)) {
            is_well = stepper_next(stepper, &err);
            onsets += stepper->is_after_onset ? 1 : 0;
            time_s = stepper->system->kind->time(stepper->system, stepper->integrator.tried);
        }
        const double part = turns / BLOCKS;
        printf("%8g %9.0f %9.0f %9.0f %8.1f %9.4f\n", turns * block / BLOCKS,
               (double)(stepper->integrator.evaluations - evaluations) / part,
               (double)(stepper->integrator.accepted - accepted) / part,
               (double)(stepper->integrator.rejected - rejected) / part, (double)onsets / part,
               (clock_processor_s() - started_s) / part);
        fflush(stdout);
    }
    if (!is_well) {
        printf("%s\n", err.text);
    }
    stepper_finish(stepper);
    free(stepper);
    return is_well ? 0 : 1;
}

// Each evaluation needs what the one before gave, as in an integrator. ns.
static double time_rates(Dynamics *dynamics, const double *y, size_t count)
{
    enum { ROUNDS = 20, EVALUATIONS = 20000 };
    const double little = 1e-300;
    double *at = calloc(2 * count, sizeof *at);
    double *rates = calloc(system_size(&dynamics->system), sizeof *rates);
    double best_s = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        const double started_s = clock_processor_s();
        for (int i = 0; i < EVALUATIONS; i++) {
            for (size_t k = 0; k < 2 * count; k++) {
                at[k] = y[k] + little * rates[k];
            }
            dynamics_rates(1e-5, at, rates, dynamics);
        }
        best_s = fmin(best_s, (clock_processor_s() - started_s) / EVALUATIONS);
    }
    free(at);
    free(rates);
    return 1e9 * best_s;
}

static int try_rates(const Scenario *scenario)
{
    Dynamics dynamics;
    Err err = {ERR_NONE, ""};
    if (scenario->linkage.is_spatial || !dynamics_init(scenario, &dynamics, &err)) {
        printf("%s\n", err.text);
        return 1;
    }
    const size_t n = dynamics.tree.coordinate_count;
    double *y = calloc(2 * n, sizeof *y);
    Motion *motions = dynamics.room.state->tree.motions;
    linkage_start(&scenario->linkage, motions);
    tree_start(&dynamics.tree, motions, y + n);
    Hinged *hinged = dynamics.hinged;
    for (int mode = CONTACT_APART; mode <= CONTACT_PRESSING; mode++) {
        for (size_t i = 0; i < dynamics.system.contact_count; i++) {
            dynamics.system.contacts[i].mode = (ContactMode)mode;
        }
        dynamics.hinged = hinged;
        const double quick_ns = hinged != NULL ? time_rates(&dynamics, y, n) : NAN;
        dynamics.hinged = NULL;
        printf("%-8s short way %6.1f ns, long way %6.1f ns\n",
               mode == CONTACT_APART ? "apart" : "pressing", quick_ns, time_rates(&dynamics, y, n));
    }
    dynamics.hinged = hinged;
    dynamics_finish(&dynamics);
    free(y);
    return 0;
}

int main(int argc, char **argv)
{
    if (argc < 3) {
        fprintf(stderr, "usage: reference_cost errors CASE | turns CASE N [TOLERANCE] | one CASE "
                        "TOLERANCE | rates CASE\n");
        return 2;
    }
    Scenario *scenario = calloc(1, sizeof *scenario);
    Err err = {ERR_NONE, ""};
    if (!casefile_load(argv[2], NULL, 0, scenario, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return 3;
    }
    int status = 2;
    if (strcmp(argv[1], "errors") == 0) {
        status = try_errors(scenario);
    } else if (strcmp(argv[1], "turns") == 0 && argc > 3) {
        status = try_turns(scenario, atof(argv[3]),
                           argc > 4 ? atof(argv[4]) : scenario->reference.tolerance);
    } else if (strcmp(argv[1], "rates") == 0) {
        status = try_rates(scenario);
    } else if (strcmp(argv[1], "one") == 0 && argc > 3) {
        double spent_s;
        Trajectory *run = run_at(scenario, atof(argv[3]), &spent_s);
        printf("%zu %zu %g %016llx\n", run->evaluations, run->steps, 1e3 * spent_s,
               (unsigned long long)run->hash);
        trajectory_destroy(run);
        status = 0;
    }
    free(scenario);
    return status;
}

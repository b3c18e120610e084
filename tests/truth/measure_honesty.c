// Is the reference as right as it says, on anybody's mechanism?
//     measure_honesty CASE [TOLERANCE_M_S [SECONDS]]
//
// Shortens the case to its first contacts, has it certified (compare/truth.h), and integrates it in
// quadruple precision up to the horizon. Prints one line of columns, by `measure_honesty --header`
// their names; status 1 where there is no truth, whose column then says why.
#include "casefile/casefile.h"
#include "measure/error.h"
#include "measure/truth.h"
#include "model/kinematics.h"
#include "run/registry.h"
#include "truth_trajectory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

// a run ends after so many contacts, or after so many steps of the reference
enum { CONTACTS = 10, STEPS = 4000, SAMPLES = 1200 };

// When enough has happened, s; fails as the reference does.
static bool find_end(const Scenario *scenario, double *end_s, Err *err)
{
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    const double whole_s = scenario_duration(scenario);
    bool was_touching[KINEMATICS_JOINT_MAX] = {false};
    size_t contacts = 0;
    void *state = NULL;
    *end_s = 0.0;
    bool is_good = solver->open(scenario, &state, err);
    for (size_t steps = 0; is_good && steps < STEPS && contacts <= CONTACTS && *end_s < whole_s;
         steps++) {
        is_good = solver->step(state, whole_s, err);
        const StepRecord record = solver->record(state);
        *end_s = record.end_s;
        for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
            const bool is_contact =
                linkage_has_play(&scenario->linkage.joints[i]) && record.joints[i].is_touching;
            contacts += is_contact && !was_touching[i] ? 1 : 0;
            was_touching[i] = is_contact;
        }
    }
    if (state != NULL) {
        solver->close(state);
    }
    // a run that ends early is measured up to there
    return is_good || *end_s > 0.0;
}

// Ends the run after its first contacts, and gives it a thousand samples.
static bool shorten(Scenario *scenario, Err *err)
{
    double end_s = 0.0;
    if (!find_end(scenario, &end_s, err)) {
        return false;
    }
    const double share = fmin(1.0, 0.999 * end_s / scenario_duration(scenario));
    scenario->run.revolutions *= share;
    scenario->run.duration *= share;
    scenario->run.samples = scenario->linkage.driver.is_present
                                ? (size_t)ceil(SAMPLES / scenario->run.revolutions)
                                : SAMPLES;
    return true;
}

static size_t count_play(const Linkage *linkage)
{
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        count += linkage_has_play(&linkage->joints[i]) ? 1 : 0;
    }
    return count;
}

static int fail(const char *path, const char *reason)
{
    printf("%s none none none 0 0 0 0 0 0 0 0 0 0 0 %s\n", path, reason);
    return 1;
}

int main(int argc, char **argv)
{
    if (argc < 2 || strcmp(argv[1], "--header") == 0) {
        printf("case kind law damping friction rpm joints contacts horizon_share growth "
               "uncertainty error evaluations truth_steps truth_s note\n");
        return argc < 2 ? 2 : 0;
    }
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    if (!casefile_load(argv[1], NULL, 0, &scenario, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return fail(argv[1], "case-refused");
    }
    if (!shorten(&scenario, &err)) {
        fprintf(stderr, "%s\n", err.text);
        return fail(argv[1], "reference-failed");
    }
    Truth truth = truth_make(&scenario, (RunWatch){NULL, NULL});
    if (truth.trajectory == NULL || !truth.trajectory->is_complete || truth.message[0] != '\0') {
        fprintf(stderr, "%s\n",
                truth.message[0] != '\0' ? truth.message : truth.trajectory->message);
        return fail(argv[1], "reference-failed");
    }
    const clock_t start = clock();
    TruthFigures figures;
    const QuadProblem problem = quad_problem(&scenario);
    TruthOptions options = truth_options_default();
    options.tolerance = argc > 2 ? atof(argv[2]) : 1e-15;
    options.seconds_max = argc > 3 ? atof(argv[3]) : 60.0;
    Trajectory *exact = truth_trajectory(&scenario, &problem, &options, truth.horizon_s, &figures);
    const double reached_s = fmin(truth.horizon_s, figures.reached_s);
    const TrajectoryError error = error_against(truth.trajectory, exact, reached_s);
    const Linkage *linkage = &scenario.linkage;
    const bool has_stiffness = scenario.contact.stiffness > 0.0;
    printf("%s %s %s %s %.3g %.4g %zu %zu %.3g %.3g %.3g %.3g %zu %zu %.2f %s\n", argv[1],
           scenario.has_fourbar ? "four-bar" : "bodies",
           has_stiffness ? "stiffness" : OPTIONS_LAWS[scenario.contact.law],
           OPTIONS_DAMPINGS[scenario.contact.damping], scenario.contact.friction,
           fabs(linkage->driver.is_present ? linkage->driver.speed : 0.0) * 30.0 / M_PI,
           count_play(linkage), figures.onsets, reached_s / scenario_duration(&scenario),
           truth.growth, truth.uncertainty, error.omega_max_in_horizon,
           truth.trajectory->evaluations, figures.steps, (double)(clock() - start) / CLOCKS_PER_SEC,
           reached_s < truth.horizon_s ? "truth-stopped" : "ok");
    trajectory_destroy(exact);
    truth_finish(&truth);
    scenario_free(&scenario);
    return 0;
}

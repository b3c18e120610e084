// Are the distributions of an ensemble those of its members?
//
// The members are run here one by one, and the deviation follows from all pairs of them:
//     s^2 = sum over i < j of (x_i - x_j)^2 / (n (n - 1))
#include "close.h"
#include "kept.h"
#include "mechanism.h"

#include "measure/ensemble.h"
#include "model/distance.h"
#include "model/perturb.h"
#include "run/registry.h"

static Scenario short_case(void)
{
    Scenario scenario = mechanism_loose(1);
    scenario.run.revolutions = 0.05;
    scenario.run.samples = 1000;
    scenario.run.step = 5e-6;
    return scenario;
}

static size_t loose_joint(const Scenario *scenario)
{
    size_t joint = 0;
    while (!linkage_has_play(&scenario->linkage.joints[joint])) {
        joint++;
    }
    return joint;
}

// The largest force on the joint with play, N, of each start.
static void run_members(const Scenario *scenario, double forces[ENSEMBLE_MEMBERS])
{
    PerturbUnit units[8];
    for (unsigned member = 0; member < ENSEMBLE_MEMBERS; member++) {
        Scenario beside = kept_copy(scenario);
        if (member > 0) {
            perturb_start(&beside, units, ENSEMBLE_PERTURBATION, member);
        }
        Trajectory *run = run_scenario(&beside, registry_solver(BACKEND_ODE), (RunWatch){0});
        assert_true(run->is_complete && run->body_count <= 8);
        if (member == 0) {
            perturb_units(run, units);
        }
        forces[member] = run->joints[loose_joint(scenario)].force_max.value;
        trajectory_destroy(run);
    }
}

static void mean_and_deviation_are_those_of_the_members(void **state)
{
    (void)state;
    const Scenario scenario = short_case();
    double forces[ENSEMBLE_MEMBERS];
    run_members(&scenario, forces);
    double sum = 0.0;
    double squares = 0.0;
    double low = INFINITY;
    double high = 0.0;
    for (int i = 0; i < ENSEMBLE_MEMBERS; i++) {
        sum += forces[i];
        low = fmin(low, forces[i]);
        high = fmax(high, forces[i]);
        for (int j = 0; j < i; j++) {
            squares += (forces[i] - forces[j]) * (forces[i] - forces[j]);
        }
    }
    const double deviation = sqrt(squares / (ENSEMBLE_MEMBERS * (ENSEMBLE_MEMBERS - 1)));
    Ensemble ensemble;
    ensemble_run(&scenario, registry_solver(BACKEND_ODE), 0.0, (RunWatch){0}, &ensemble);
    const Distribution *found = &ensemble.joints[loose_joint(&scenario)][ENSEMBLE_FORCE_MAX];
    print_message("# forces %.6g to %.6g N, mean %.6g, deviation %.3g\n", found->low, found->high,
                  found->mean, found->deviation);
    assert_true(found->low == low && found->high == high && high > low);
    assert_close(found->mean, sum / ENSEMBLE_MEMBERS, 1e-13);
    // the rounding of the mean
    assert_near(found->deviation, deviation, 1e-6 * deviation + 1e-15 * found->mean);
}

// A budget that is spent at once allows one start, and is no failure of the others.
static void a_budget_ends_it_and_says_how_many_there_are(void **state)
{
    (void)state;
    const Scenario scenario = short_case();
    Ensemble ensemble;
    ensemble_run(&scenario, registry_solver(BACKEND_ODE), 1e-9, (RunWatch){0}, &ensemble);
    assert_int_equal(ensemble.members, 1);
    assert_int_equal(ensemble.failed, 0);
    // the control: with time for all there are all
    ensemble_run(&scenario, registry_solver(BACKEND_ODE), 1e9, (RunWatch){0}, &ensemble);
    assert_int_equal(ensemble.members, ENSEMBLE_MEMBERS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mean_and_deviation_are_those_of_the_members),
        cmocka_unit_test(a_budget_ends_it_and_says_how_many_there_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

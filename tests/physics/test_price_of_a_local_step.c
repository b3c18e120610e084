// Is no more spent on the contacts within a step than the step can deliver?
#include "complete_run.h"
#include "load_case.h"

#include "measure/error.h"

// One revolution of the paper's case against the reference.
static double error_of(Scenario *scenario, const Trajectory *truth, double step_s, double phase,
                       size_t *evaluations)
{
    scenario->run.step = step_s;
    scenario->ode.contact_phase = phase;
    Trajectory *run = complete_run(scenario, BACKEND_ODE);
    const double error = error_against(run, truth, INFINITY).omega_max;
    *evaluations = run->evaluations;
    trajectory_destroy(run);
    return error;
}

static void an_error_costs_few_evaluations_of_forces(void **state)
{
    (void)state;
    Scenario scenario = load_with("cases/paper/impact-k66.yaml", "run.samples=600");
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    size_t evaluations;
    size_t more;
    assert_true(error_of(&scenario, truth, 110e-6, 0.0, &evaluations) < 5e-4);
    assert_true(evaluations < 6000);
    // control: contacts integrated as finely as suits no step in particular
    error_of(&scenario, truth, 110e-6, 0.05, &more);
    assert_true(more > 2 * evaluations);
    assert_true(error_of(&scenario, truth, 15e-6, 0.0, &evaluations) < 1e-6);
    assert_true(evaluations < 16000);
    // control: bodies that answer the contacts as at mid-step throughout
    scenario.ode.is_frozen = true;
    assert_true(error_of(&scenario, truth, 15e-6, 0.0, &evaluations) > 4e-6);
    trajectory_destroy(truth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_error_costs_few_evaluations_of_forces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Does Simbody, by its driver, move ideal joints and one impact as it must?
//
// Truths: the closed form of the ideal four-bar, and the reference's run of the paper's mechanism
// with play. The control of each way is a coarser step, whose error is far larger.
#include "engine_outcome.h"
#include "engine_rubs.h"

static const char SIMBODY[] = "simbody";

static void every_number_is_named(void **state)
{
    (void)state;
    const EngineDriver driver = engine_named(SIMBODY);
    assert_string_equal(driver.engine, "Simbody");
    assert_string_equal(driver.precision, "double");
    assert_true(driver.version[0] >= '3');
    assert_int_equal(driver.way_count, 4);
}

// Merson's method is of order 4, and the joints are held to 1e-8.
static void ideal_joints_are_of_order_four(void **state)
{
    (void)state;
    double errors[2];
    for (int i = 0; i < 2; i++) {
        Scenario scenario = load("cases/paper/ideal-nominal.yaml", NULL, 0);
        scenario.run.step = i == 0 ? 500e-6 : 250e-6;
        // at samples that are ends of steps: between them the driver interpolates
        scenario.run.samples = 120;
        const Outcome outcome = outcome_of(SIMBODY, "force", &scenario, BACKEND_ANALYTIC);
        errors[i] = outcome.error.omega_max;
        assert_true(outcome.said.opening_m < 1e-7);
    }
    assert_true(errors[0] < 1e-4);
    assert_true(log(errors[0] / errors[1]) / log(2.0) > 3.5);
}

static void the_law_as_a_force_converges(void **state)
{
    (void)state;
    Scenario scenario = impact(20e-6);
    const Outcome coarse = outcome_of(SIMBODY, "force", &scenario, BACKEND_REFERENCE);
    scenario.run.step = 5e-6;
    const Outcome fine = outcome_of(SIMBODY, "force", &scenario, BACKEND_REFERENCE);
    assert_true(fine.error.omega_max < 1e-4);
    assert_true(coarse.error.omega_max > 5.0 * fine.error.omega_max);
    assert_close(fine.force_ratio, 1.0, 1e-3);
}

static void its_own_steps_reach_an_accuracy(void **state)
{
    (void)state;
    Scenario scenario = impact(100e-6);
    const Outcome loose = outcome_of(SIMBODY, "adaptive", &scenario, BACKEND_REFERENCE);
    scenario.run.step = 1e-6;
    const Outcome tight = outcome_of(SIMBODY, "adaptive", &scenario, BACKEND_REFERENCE);
    assert_true(tight.error.omega_max < 1e-4);
    assert_true(loose.error.omega_max > 5.0 * tight.error.omega_max);
}

static void a_slider_crank_can_be_told(void **state)
{
    (void)state;
    hold_slider_crank(SIMBODY, "force", 50e-6, 1e-5);
}

static void contacts_in_the_step_are_as_good_as_those_of_ode(void **state)
{
    (void)state;
    hold_kernel_against_ode(SIMBODY);
}

static void steps_tell_of_every_contact(void **state)
{
    (void)state;
    hold_contacts(BACKEND_SIMBODY);
}

static void springs_and_torques_act(void **state)
{
    (void)state;
    hold_springs(SIMBODY);
    hold_random_springs(SIMBODY, 39u);
}

static void sliders_go_along_any_line(void **state)
{
    (void)state;
    hold_random_sliders(SIMBODY, 20u);
}

static void the_largest_force_is_between_steps(void **state)
{
    (void)state;
    hold_largest_force(SIMBODY, "force");
}

static void bushings_act(void **state)
{
    (void)state;
    hold_bushings(SIMBODY, "force", 800e-6, 2.7, 1e-4);
}

static void loads_and_motors_act(void **state)
{
    (void)state;
    // the load's curvature jumps at its points, which keeps order 4 away
    hold_load(SIMBODY, "force", 800e-6, 2.7, 1e-5);
}

static void friction_acts(void **state)
{
    (void)state;
    hold_friction(SIMBODY);
}

static void ideal_joints_rub(void **state)
{
    (void)state;
    hold_random_rubs(SIMBODY, 21, 2);
    hold_drags(SIMBODY, "force", 1e-3, 2.7, 1e-3);
}

static void whole_cases_are_taken(void **state)
{
    (void)state;
    hold_whole_cases(SIMBODY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contacts_in_the_step_are_as_good_as_those_of_ode),
        cmocka_unit_test(steps_tell_of_every_contact),
        cmocka_unit_test(every_number_is_named),
        cmocka_unit_test(whole_cases_are_taken),
        cmocka_unit_test(springs_and_torques_act),
        cmocka_unit_test(sliders_go_along_any_line),
        cmocka_unit_test(the_largest_force_is_between_steps),
        cmocka_unit_test(bushings_act),
        cmocka_unit_test(loads_and_motors_act),
        cmocka_unit_test(friction_acts),
        cmocka_unit_test(ideal_joints_rub),
        cmocka_unit_test(ideal_joints_are_of_order_four),
        cmocka_unit_test(the_law_as_a_force_converges),
        cmocka_unit_test(its_own_steps_reach_an_accuracy),
        cmocka_unit_test(a_slider_crank_can_be_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

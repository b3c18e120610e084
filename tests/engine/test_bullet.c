// Does Bullet, by its driver, move ideal joints and one impact as it must, in each of its ways?
//
// Truths: the closed form of the ideal four-bar, and the reference's run of the paper's mechanism
// with play. The control of each way is another one, whose error is far larger.
#include "engine_outcome.h"
#include "engine_rubs.h"

static const char BULLET[] = "bullet";

static void every_number_is_named(void **state)
{
    (void)state;
    const EngineDriver driver = engine_named(BULLET);
    assert_string_equal(driver.engine, "Bullet");
    assert_string_equal(driver.precision, "double");
    assert_true(driver.version[0] >= '3');
    assert_int_equal(driver.way_count, 4);
}

// The order of the error of the angular velocities of ideal joints, and that at the coarsest step.
static double order_of_ideal(const char *way, double *coarse)
{
    static const double STEPS[] = {100e-6, 50e-6, 25e-6};
    double errors[3];
    for (int i = 0; i < 3; i++) {
        Scenario scenario = load("cases/paper/ideal-nominal.yaml", NULL, 0);
        scenario.run.step = STEPS[i];
        const Outcome outcome = outcome_of(BULLET, way, &scenario, BACKEND_ANALYTIC);
        errors[i] = outcome.error.omega_max;
        assert_true(outcome.said.opening_m < 1e-4);
    }
    const Order order = order_fit(3, STEPS, errors, 0.0);
    assert_true(order.is_known);
    *coarse = errors[0];
    return order.order;
}

// The very same steps, read as the end of the step and as half a step later.
static void half_a_step_makes_the_order(void **state)
{
    (void)state;
    double plain;
    double staggered;
    assert_near(order_of_ideal("force", &plain), 1.0, 0.1);
    assert_near(order_of_ideal("staggered", &staggered), 2.0, 0.1);
    // 7.8e-4 at 10 us, as ODE and every engine of that method
    assert_near(plain, 7.8e-3, 0.8e-3);
    assert_true(staggered < 0.1 * plain);
}

static void the_law_as_a_force_converges(void **state)
{
    (void)state;
    Scenario scenario = impact(10e-6);
    const Outcome coarse = outcome_of(BULLET, "staggered", &scenario, BACKEND_REFERENCE);
    scenario.run.step = 2e-6;
    const Outcome fine = outcome_of(BULLET, "staggered", &scenario, BACKEND_REFERENCE);
    const Outcome plain = outcome_of(BULLET, "force", &scenario, BACKEND_REFERENCE);
    const double ratio = coarse.error.omega_max / fine.error.omega_max;
    assert_true(log(ratio) / log(5.0) > 1.6);
    assert_true(coarse.error.omega_max < 4e-3);
    assert_close(fine.force_ratio, 1.0, 3e-2);
    assert_true(plain.error.omega_max > 3.0 * fine.error.omega_max);
}

static void a_slider_crank_can_be_told(void **state)
{
    (void)state;
    hold_slider_crank(BULLET, "staggered", 20e-6, 1e-2);
}

static void contacts_in_the_step_are_as_good_as_those_of_ode(void **state)
{
    (void)state;
    hold_kernel_against_ode(BULLET);
}

static void steps_tell_of_every_contact(void **state)
{
    (void)state;
    hold_contacts(BACKEND_BULLET);
}

static void springs_and_torques_act(void **state)
{
    (void)state;
    hold_springs(BULLET);
    hold_random_springs(BULLET, 41u);
}

static void sliders_go_along_any_line(void **state)
{
    (void)state;
    hold_random_sliders(BULLET, 20u);
}

static void bushings_act(void **state)
{
    (void)state;
    hold_bushings(BULLET, "staggered", 100e-6, 2, 1e-4);
}

static void loads_and_motors_act(void **state)
{
    (void)state;
    hold_load(BULLET, "staggered", 100e-6, 2, 0.001);
}

static void friction_acts(void **state)
{
    (void)state;
    hold_friction(BULLET);
}

static void ideal_joints_rub(void **state)
{
    (void)state;
    hold_random_rubs(BULLET, 11, 2);
    hold_drags(BULLET, "staggered", 200e-6, 2, 1e-3);
}

static void whole_cases_are_taken(void **state)
{
    (void)state;
    hold_whole_cases(BULLET);
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
        cmocka_unit_test(bushings_act),
        cmocka_unit_test(loads_and_motors_act),
        cmocka_unit_test(friction_acts),
        cmocka_unit_test(ideal_joints_rub),
        cmocka_unit_test(half_a_step_makes_the_order),
        cmocka_unit_test(the_law_as_a_force_converges),
        cmocka_unit_test(a_slider_crank_can_be_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Does Chipmunk, by its driver, move ideal joints and one impact as it must, in each of its ways?
//
// Truths: the closed form of the ideal four-bar, and the reference's run of the paper's mechanism
// with play. The control of each way is another one, whose error is far larger.
#include "engine_outcome.h"
#include "engine_rubs.h"
#include "measure/chosen_run.h"
#include "run/settle.h"

static const char CHIPMUNK[] = "chipmunk";

static void every_number_is_named(void **state)
{
    (void)state;
    const EngineDriver driver = engine_named(CHIPMUNK);
    assert_string_equal(driver.engine, "Chipmunk");
    assert_string_equal(driver.precision, "double");
    assert_true(driver.version[0] >= '7');
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
        const Outcome outcome = outcome_of(CHIPMUNK, way, &scenario, BACKEND_ANALYTIC);
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
    assert_near(order_of_ideal("native", &plain), 1.0, 0.1);
    assert_near(order_of_ideal("staggered", &staggered), 2.0, 0.1);
    // 7.8e-4 at 10 us, as ODE and every engine of that method
    assert_near(plain, 7.8e-3, 0.8e-3);
    assert_true(staggered < 0.1 * plain);
}

static void the_law_as_a_force_converges(void **state)
{
    (void)state;
    Scenario scenario = impact(10e-6);
    const Outcome coarse = outcome_of(CHIPMUNK, "staggered", &scenario, BACKEND_REFERENCE);
    scenario.run.step = 2e-6;
    const Outcome fine = outcome_of(CHIPMUNK, "staggered", &scenario, BACKEND_REFERENCE);
    const Outcome plain = outcome_of(CHIPMUNK, "force", &scenario, BACKEND_REFERENCE);
    const double ratio = coarse.error.omega_max / fine.error.omega_max;
    assert_true(log(ratio) / log(5.0) > 1.6);
    assert_true(coarse.error.omega_max < 4e-3);
    assert_close(fine.force_ratio, 1.0, 5e-3);
    assert_true(plain.error.omega_max > 5.0 * fine.error.omega_max);
}

// A slide joint is rigid: it holds the pin, and hits harder than the law.
static void a_slide_joint_holds_the_pin(void **state)
{
    (void)state;
    Scenario scenario = impact(10e-6);
    const Outcome native = outcome_of(CHIPMUNK, "native", &scenario, BACKEND_REFERENCE);
    assert_true(native.error.omega_max < 0.05);
    assert_true(native.force_ratio > 2.0);
}

static void a_slider_crank_can_be_told(void **state)
{
    (void)state;
    hold_slider_crank(CHIPMUNK, "staggered", 20e-6, 1e-2);
}

// A follower lighter than its coupler by far, where 30 iterations, enough for the case as it is,
// leave an error of 5e-3.
static void iterations_are_enough_for_any_masses(void **state)
{
    (void)state;
    static const char *const OVERRIDES[] = {"run.start=centred", "run.revolutions=0.1",
                                            "run.samples=100", "four-bar.follower.mass=0.01 kg",
                                            "four-bar.follower.inertia=20 kg mm^2"};
    Scenario light = load("cases/paper/impact-k66.yaml", OVERRIDES, 5);
    light.run.step = 10e-6;
    const double error = omega_error(CHIPMUNK, "kernel", &light, &light);
    if (!(error < 1e-6)) {
        fail_msg("a light follower: %g", error);
    }
}

static void contacts_in_the_step_are_as_good_as_those_of_ode(void **state)
{
    (void)state;
    hold_kernel_against_ode(CHIPMUNK);
}

static void steps_tell_of_every_contact(void **state)
{
    (void)state;
    hold_contacts(BACKEND_CHIPMUNK);
}

// Chipmunk has run the whole motion before its first sample is looked at: where a trial is given up
// there, of 5000 samples, its steps are those of all. Taken for a sample's steps, no run was
// thought to come to its end within run.most-steps.
static void its_step_can_be_chosen(void **state)
{
    (void)state;
    static const char *const OVERRIDES[] = {"run.start=settled", "run.revolutions=0.3",
                                            "run.samples=5000", "run.step=auto",
                                            "run.tolerance=1e-3"};
    Scenario scenario = load("cases/paper/impact-k66.yaml", OVERRIDES, 5);
    settle_scenario(&scenario, NOBODY);
    const ChosenWatch watch = {.run = NOBODY};
    Trajectory *run = backend_run(&scenario, BACKEND_CHIPMUNK, NULL, watch, NULL);
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    assert_false(run->is_short);
    assert_true(run->error_estimate <= 1e-3);
    trajectory_destroy(run);
}

static void springs_and_torques_act(void **state)
{
    (void)state;
    hold_springs(CHIPMUNK);
    hold_random_springs(CHIPMUNK, 40u);
}

static void sliders_go_along_any_line(void **state)
{
    (void)state;
    hold_random_sliders(CHIPMUNK, 20u);
}

static void bushings_act(void **state)
{
    (void)state;
    hold_bushings(CHIPMUNK, "staggered", 100e-6, 2, 1e-4);
}

static void loads_and_motors_act(void **state)
{
    (void)state;
    hold_load(CHIPMUNK, "staggered", 100e-6, 2, 0.001);
}

static void friction_acts(void **state)
{
    (void)state;
    hold_friction(CHIPMUNK);
}

static void ideal_joints_rub(void **state)
{
    (void)state;
    hold_random_rubs(CHIPMUNK, 1, 2);
    hold_drags(CHIPMUNK, "staggered", 200e-6, 2, 1e-3);
}

static void whole_cases_are_taken(void **state)
{
    (void)state;
    hold_whole_cases(CHIPMUNK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contacts_in_the_step_are_as_good_as_those_of_ode),
        cmocka_unit_test(steps_tell_of_every_contact),
        cmocka_unit_test(every_number_is_named),
        cmocka_unit_test(whole_cases_are_taken),
        cmocka_unit_test(its_step_can_be_chosen),
        cmocka_unit_test(springs_and_torques_act),
        cmocka_unit_test(sliders_go_along_any_line),
        cmocka_unit_test(bushings_act),
        cmocka_unit_test(loads_and_motors_act),
        cmocka_unit_test(friction_acts),
        cmocka_unit_test(ideal_joints_rub),
        cmocka_unit_test(half_a_step_makes_the_order),
        cmocka_unit_test(the_law_as_a_force_converges),
        cmocka_unit_test(a_slide_joint_holds_the_pin),
        cmocka_unit_test(a_slider_crank_can_be_told),
        cmocka_unit_test(iterations_are_enough_for_any_masses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Are linkages of ideal joints followed through change points, where the joints' rows depend on one
// another, and does a run that leaves its branch there say so?
//
// N four-bars in a row, problem A02 of the IFToMM benchmark library (tests/support/four_bars.h).
#include "four_bars.h"
#include "kept.h"
#include "ode_error.h"

#include <stdio.h>
#include <string.h>

static Scenario four_bars(size_t count, double duration_s)
{
    Scenario scenario = kept_default();
    four_bars_fill(&scenario, count, duration_s);
    return scenario;
}

// How far the tip of any upright is at the end from where an angle with that sine and cosine has
// it, m.
static double tip_error(const Trajectory *run, double sine, double cosine)
{
    return four_bars_error(run, atan2(sine, cosine));
}

static void the_reference_keeps_the_branch_to_a_billionth(void **state)
{
    (void)state;
    // at 10 s, by a series of order 40 in 50 digits
    const double sines[] = {0.47838505776097056676, 0.32845811154081538952};
    const double cosines[] = {0.87815017879120926825, 0.94451853817860098594};
    for (size_t count = 1; count <= 2; count++) {
        const Scenario scenario = four_bars(count, 10.0);
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        assert_near(tip_error(run, sines[count - 1], cosines[count - 1]), 0.0, 1e-9);
        // of some 60 J that swing
        assert_near(run->energy.residual, 0.0, 6e-9);
        // the control: the other mechanism
        assert_true(tip_error(run, sines[2 - count], cosines[2 - count]) > 0.1);
        trajectory_destroy(run);
        const double theta = four_bars_angle(count, 10.0).theta;
        assert_near(hypot(sin(theta) - sines[count - 1], cos(theta) - cosines[count - 1]), 0.0,
                    1e-10);
    }
}

// A linkage with room for as many four-bars as the tests of many have.
enum { MANY = 40 };

static Scenario many_four_bars(double duration_s)
{
    Scenario scenario = scenario_default();
    scenario.linkage =
        linkage_create((LinkageRoom){.bodies = 2 * MANY + 1, .joints = 3 * MANY + 1});
    four_bars_fill(&scenario, MANY, duration_s);
    return scenario;
}

static void the_reference_keeps_the_branch_of_forty_four_bars(void **state)
{
    (void)state;
    // at 20 s, by a series of order 40 in 50 digits
    const double sine = 0.41090115376294522598;
    const double cosine = 0.91167990097198070565;
    Scenario scenario = many_four_bars(20.0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_near(tip_error(run, sine, cosine), 0.0, 1e-9);
    assert_true(four_bars_spread(run) < 1e-9);
    // of some 1200 J that swing
    assert_near(run->energy.residual, 0.0, 1e-8);
    trajectory_destroy(run);
    linkage_free(&scenario.linkage);
}

static Trajectory *run_many_in_ode(size_t iterations)
{
    Scenario scenario = many_four_bars(4.0);
    scenario.run.step = 1e-3;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.solver = iterations > 0 ? ODE_QUICK : ODE_DIRECT;
    scenario.ode.iterations = iterations > 0 ? iterations : 1;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    linkage_free(&scenario.linkage);
    return run;
}

static void ode_keeps_the_branch_of_forty_four_bars(void **state)
{
    (void)state;
    const double theta = four_bars_angle(MANY, 4.0).theta;
    Trajectory *run = run_many_in_ode(0);
    assert_true(four_bars_error(run, theta) < 1e-4);
    assert_true(four_bars_spread(run) < 1e-9);
    trajectory_destroy(run);
    // the control: with a single iteration of the quick solver it is left
    Trajectory *loose = run_many_in_ode(1);
    assert_true(four_bars_error(loose, theta) > 0.1);
    assert_true(four_bars_spread(loose) > 0.1);
    trajectory_destroy(loose);
}

static double ode_tip_error(size_t count, OdeStepping stepping, double step_s)
{
    Scenario scenario = four_bars(count, 4.0);
    scenario.ode.stepping = stepping;
    scenario.run.step = step_s;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const double error = four_bars_error(run, four_bars_angle(count, 4.0).theta);
    trajectory_destroy(run);
    return error;
}

static void ode_keeps_the_branch_with_its_orders(void **state)
{
    (void)state;
    const double coarse = ode_tip_error(2, ODE_STAGGERED, 1e-3);
    const double fine = ode_tip_error(2, ODE_STAGGERED, 2.5e-4);
    assert_true(ode_order(coarse, fine, 4.0) > 1.9);
    assert_true(fine < 1e-4);
    const double high_coarse = ode_tip_error(2, ODE_EXTRAPOLATED, 1e-3);
    const double high_fine = ode_tip_error(2, ODE_EXTRAPOLATED, 5e-4);
    assert_true(ode_order(high_coarse, high_fine, 2.0) > 4.0);
    assert_true(high_fine < 1e-5);
}

// A coupler that is a little too long has no change point but a corner close by, sharper the less
// it is: what cannot be followed must not be handed out.
static void a_run_that_loses_its_branch_says_so(void **state)
{
    (void)state;
    size_t failed = 0;
    for (int i = 0; i < 6; i++) {
        Scenario scenario = four_bars(1, 4.0);
        scenario.linkage.joints[2].anchor_b.x += pow(10.0, -16 + i);
        Trajectory *run =
            run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
        if (run->is_complete) {
            assert_near(run->energy.residual, 0.0, 1e-4);
        } else {
            assert_non_null(strstr(run->message, "change point"));
            failed++;
        }
        trajectory_destroy(run);
    }
    assert_true(failed > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_reference_keeps_the_branch_to_a_billionth),
        cmocka_unit_test(the_reference_keeps_the_branch_of_forty_four_bars),
        cmocka_unit_test(ode_keeps_the_branch_of_forty_four_bars),
        cmocka_unit_test(ode_keeps_the_branch_with_its_orders),
        cmocka_unit_test(a_run_that_loses_its_branch_says_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

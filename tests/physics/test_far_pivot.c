// Does it matter how far away the pivot is that a body turns about?
//
// A slider-crank whose slider is the end of a rocker of length L: from 10 m on its path is straight
// to a quarter of its play, from 100 m on to a fortieth. So work, errors and, over many starts,
// horizons and forces are those of any other length. Starts differ by a thousandth: each by itself
// is chaotic.
#include "close.h"

#include "complete_run.h"
#include "rocker.h"
#include "starts.h"

#include "measure/error.h"
#include "model/kinematics.h"

enum { PIN = 2, ROCKER = 2, STARTS = 24 };

static const Starts BESIDE = {.size = 1e-3, .seed = 1, .count = STARTS};

static Scenario rocker_of(double length, double tolerance, double turns)
{
    Scenario scenario = rocker_make((RockerView){.length = length});
    scenario.reference.tolerance = tolerance;
    scenario.run.revolutions = turns;
    return scenario;
}

static double evaluations_of(double length, double tolerance)
{
    const Scenario scenario = rocker_of(length, tolerance, 1.0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const double evaluations = (double)run->evaluations;
    trajectory_destroy(run);
    return evaluations;
}

// Control: a hundredth of the tolerance costs more than that.
static void it_costs_no_more_work(void **state)
{
    (void)state;
    const double most = 1.25;
    const double near = evaluations_of(10.0, 3e-13);
    for (double length = 30.0; length < 2000.0; length *= 3.0) {
        const double far = evaluations_of(length, 3e-13);
        assert_true(far <= most * near);
        assert_true(near <= most * far);
    }
    assert_true(evaluations_of(10.0, 3e-15) > most * near);
}

// Error of the speeds over the first impacts, before they are chaotic.
static double error_of(double length, double tolerance)
{
    const Scenario rough = rocker_of(length, tolerance, 0.15);
    const Scenario fine = rocker_of(length, 1e-14, 0.15);
    Trajectory *run = complete_run(&rough, BACKEND_REFERENCE);
    Trajectory *truth = complete_run(&fine, BACKEND_REFERENCE);
    assert_true(truth->joints[PIN].impacts >= 2);
    const TrajectoryError error = error_against(run, truth, INFINITY);
    assert_true(error.is_known);
    trajectory_destroy(run);
    trajectory_destroy(truth);
    return error.max;
}

// Control: a hundred times the tolerance is seen.
static void it_costs_no_digits(void **state)
{
    (void)state;
    const double most = 2.0;
    const double near = error_of(10.0, 1e-10);
    for (double length = 30.0; length < 2000.0; length *= 3.0) {
        const double far = error_of(length, 1e-10);
        print_message("# %g m: error %.3g, of 10 m %.3g\n", length, far, near);
        assert_true(far <= most * near);
    }
    assert_true(error_of(1000.0, 1e-8) > most * near);
}

// Whether two medians differ by no more than their sampling.
static bool is_same(Median a, Median b)
{
    print_message("# %.4g +- %.2g, %.4g +- %.2g\n", a.value, a.error, b.value, b.error);
    return fabs(a.value - b.value) <= 3.0 * hypot(a.error, b.error);
}

static void median_horizons_and_forces_are_the_same(void **state)
{
    (void)state;
    Median horizon[2];
    Median force[2];
    Median impulse[2];
    PerturbUnit units[KINEMATICS_BODY_MAX];
    Scenario scenario;
    for (int i = 0; i < 2; i++) {
        scenario = rocker_of(i == 0 ? 100.0 : 1000.0, 1e-12, 3.0);
        starts_units(&scenario, units);
        horizon[i] = starts_horizon(&scenario, units, BESIDE);
        scenario.run.revolutions = 1.0;
        scenario.run.samples = 360;
        scenario.run.step = 4e-6;
        starts_impact(&scenario, units, BESIDE, PIN, &force[i], &impulse[i]);
        assert_true(horizon[i].error < 0.3 * horizon[i].value);
        assert_true(force[i].error < 0.1 * force[i].value);
    }
    assert_true(is_same(horizon[0], horizon[1]));
    assert_true(is_same(force[0], force[1]));
    assert_true(is_same(impulse[0], impulse[1]));

    // control: a rocker of 30 m changed by a thousandth of the drive's speed
    scenario = rocker_of(30.0, 1e-12, 1.0);
    scenario.run.samples = 360;
    scenario.run.step = 4e-6;
    starts_units(&scenario, units);
    units[ROCKER].turning = scenario.linkage.driver.speed;
    units[ROCKER].moving = scenario.linkage.driver.speed * 30.0;
    starts_impact(&scenario, units, BESIDE, PIN, &force[1], &impulse[1]);
    assert_false(is_same(force[0], force[1]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_costs_no_more_work),
        cmocka_unit_test(it_costs_no_digits),
        cmocka_unit_test(median_horizons_and_forces_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Is the uncertainty that the reference states as large as its error, and not much larger?
//
// The paper's four-bar with K = 6.6e10 N/m^1.5 at slow speeds: the play is crossed slowly, impacts
// magnify what went before a thousand times, and rounding of positions shows. The error is that
// against 128-bit integration, over the first contacts.
//
// A pin dropped in its hole, looked at before it falls and just short of the top of its rebound:
// errors are relative to the speed that it has there, a small share of the speed of its impact.
#include "close.h"

#include "mechanism.h"
#include "problems.h"
#include "truth_trajectory.h"

#include "measure/error.h"
#include "measure/truth.h"

// The requirement: an error is at most this many times the uncertainty stated.
static const double COVERED = 3.0;

// An uncertainty of more than this many errors would hide what the reference can do.
static const double TOO_CAUTIOUS = 30.0;

static const RunWatch NOBODY = {NULL, NULL};

static Scenario slow_case(double rpm, double turns, double tolerance)
{
    Scenario scenario = problem_scenario(&PROBLEMS[0]);
    scenario.gravity = scenario_downward(9.80665);
    scenario.linkage.driver.speed = rpm * M_PI / 30.0;
    const double slower = rpm / 1000.0;
    for (size_t i = 0; i < scenario.linkage.body_count; i++) {
        Motion *start = &scenario.linkage.bodies[i].start;
        start->velocity = vec2_scale(slower, start->velocity);
        start->omega *= slower;
    }
    scenario.run.revolutions = turns;
    scenario.run.samples = (size_t)(1000.0 / turns);
    scenario.reference.tolerance = tolerance;
    return scenario;
}

static double error_of(const Scenario *scenario, const Truth *truth, double speed_share)
{
    QuadProblem problem = quad_problem(scenario);
    problem.impact_speed_share = speed_share;
    TruthOptions options = truth_options_default();
    options.tolerance = 1e-15;
    TruthFigures figures;
    Trajectory *exact = truth_trajectory(scenario, &problem, &options, truth->horizon_s, &figures);
    assert_true(figures.onsets >= 2);
    assert_close(figures.reached_s, truth->horizon_s, 1e-12);
    const TrajectoryError error = error_against(truth->trajectory, exact, truth->horizon_s);
    trajectory_destroy(exact);
    assert_true(error.is_known);
    return error.max_in_horizon;
}

static void check(double rpm, double turns, double tolerance, bool has_control)
{
    const Scenario scenario = slow_case(rpm, turns, tolerance);
    Truth truth = truth_make(&scenario, NOBODY);
    assert_true(truth.trajectory->is_complete);
    assert_string_equal(truth.message, "");
    const double error = error_of(&scenario, &truth, 1.0);
    print_message("# %g rpm, tolerance %.3g: uncertainty %.3g, error %.3g, growth %.3g\n", rpm,
                  tolerance, truth.uncertainty, error, truth.growth);
    assert_true(truth.uncertainty > 0.0);
    assert_true(error <= COVERED * truth.uncertainty);
    assert_true(truth.uncertainty <= TOO_CAUTIOUS * error);
    // the control: an impact speed off by a millionth is no longer covered
    if (has_control) {
        assert_true(error_of(&scenario, &truth, 1.0 + 1e-6) > COVERED * truth.uncertainty);
    }
    truth_finish(&truth);
}

static void a_slow_mechanism_is_as_right_as_it_says(void **state)
{
    (void)state;
    check(60.0, 0.05, 3e-14, false);
    check(100.0, 0.05, 3e-14, true);
    check(150.0, 0.05, 3e-14, false);
    check(170.0, 0.05, 3e-14, false);
}

static void at_the_default_tolerance_it_is_as_well(void **state)
{
    (void)state;
    check(100.0, 0.05, reference_options_default().tolerance, true);
}

// With so many samples after the start, the last of them near the top of the rebound.
static Scenario dropped_pin(size_t samples)
{
    Scenario scenario = mechanism_pin(0.1, 1e-4);
    scenario.gravity = scenario_downward(9.80665);
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.damping = DAMPING_LANKARANI_NIKRAVESH;
    scenario.contact.restitution = 0.9;
    scenario.run.duration = 8.5e-3;
    scenario.run.samples = samples;
    return scenario;
}

static void samples_that_miss_the_speed_state_their_error_as_well(void **state)
{
    (void)state;
    const Scenario few = dropped_pin(1);
    Truth truth = truth_make(&few, NOBODY);
    assert_string_equal(truth.message, "");
    const QuadProblem problem = quad_problem(&few);
    const TruthOptions options = truth_options_default();
    TruthFigures figures;
    Trajectory *exact = truth_trajectory(&few, &problem, &options, truth.horizon_s, &figures);
    const double error = error_against(truth.trajectory, exact, truth.horizon_s).max;
    // the control: relative to the speed of the impact, which other samples see
    const Scenario many = dropped_pin(1000);
    Truth at_impact = truth_make(&many, NOBODY);
    print_message("# one sample: uncertainty %.3g, error %.3g; a thousand: uncertainty %.3g\n",
                  truth.uncertainty, error, at_impact.uncertainty);
    assert_int_equal(figures.ends, 1);
    assert_true(error <= COVERED * truth.uncertainty);
    assert_true(truth.uncertainty <= TOO_CAUTIOUS * error);
    assert_true(error > COVERED * at_impact.uncertainty);
    trajectory_destroy(exact);
    truth_finish(&truth);
    truth_finish(&at_impact);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slow_mechanism_is_as_right_as_it_says),
        cmocka_unit_test(at_the_default_tolerance_it_is_as_well),
        cmocka_unit_test(samples_that_miss_the_speed_state_their_error_as_well),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

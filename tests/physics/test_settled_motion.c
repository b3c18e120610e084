// Does a mechanism come to one motion from every start, and does every solver begin in it?
//
// A contact that forgets its impact once it has outlasted it (kernel/contact_state.h) leads to one
// largest force from all starts; the control remembers it, and the same starts settle at forces
// some per cent apart. The truth for the settled motion is one run of many revolutions, which no
// state was taken out of.
#include "complete_run.h"
#include "load_case.h"
#include "ode_error.h"

#include "model/perturb.h"
#include "run/settle.h"
#include "run/tracer.h"

enum { STARTS = 4, MOST = 30 };

static const char *const CASE = "cases/paper/impact-k66.yaml";
static const double TOLERANCE = 1e-7;

static double settled_force(const Scenario *scenario, unsigned member)
{
    PerturbUnit units[3];
    for (int i = 0; i < 3; i++) {
        const double speed = fabs(scenario->linkage.driver.speed);
        units[i] = (PerturbUnit){speed * linkage_reach(&scenario->linkage, i), speed};
    }
    Settling settling = settling_start(scenario);
    if (member > 0) {
        assert_true(perturb_start(&settling.scenario, units, 0.05 * member, member));
    }
    Err err = {ERR_NONE, ""};
    assert_true(settling_run(&settling, TOLERANCE, MOST, &err));
    assert_int_equal(settling.period, 1);
    const Revolution *last = &settling.revolutions[settling.count - 1];
    double force = 0.0;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        force = fmax(force, last->force_max[i]);
    }
    settling_finish(&settling);
    return force;
}

// By how much the forces from all starts differ, over the first.
static double spread(const char *resting)
{
    const Scenario scenario = load_with(CASE, resting);
    const double first = settled_force(&scenario, 0);
    double most = 0.0;
    for (unsigned member = 1; member < STARTS; member++) {
        most = fmax(most, fabs(settled_force(&scenario, member) - first) / first);
    }
    return most;
}

static void every_start_comes_to_one_motion(void **state)
{
    (void)state;
    assert_true(spread("contact.resting-speed=50 mm/s") < 1e-6);
    assert_true(spread("contact.resting-speed=none") > 1e-2);
}

// The extremes within the steps are looked for.
static Trajectory *traced_run(const Scenario *scenario, const Solver *solver)
{
    Trajectory *run =
        run_guarded(scenario, solver, (RunWatch){.progress = NULL}, &TRACER_PROBE, NULL);
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    return run;
}

static double largest_force(const Trajectory *run)
{
    double force = 0.0;
    for (size_t i = 0; i < run->joint_count; i++) {
        force = trajectory_feels_play(run, &run->linkage.joints[i])
                    ? fmax(force, run->joints[i].force_max.value)
                    : force;
    }
    return force;
}

static void it_is_what_a_long_run_comes_to(void **state)
{
    (void)state;
    static const char *const LONG[] = {"contact.resting-speed=50 mm/s", "run.revolutions=8",
                                       "run.report-from=7 revolutions", "run.samples=36"};
    static const char *const SETTLED[] = {"contact.resting-speed=50 mm/s", "run.start=settled"};
    const Scenario slow = load(CASE, LONG, 4);
    Scenario settled = load(CASE, SETTLED, 2);
    settle_scenario(&settled);
    kept_hold(settled.settled.joints);
    assert_int_equal(settled.settled.period, 1);
    Trajectory *truth = traced_run(&slow, &REFERENCE_SOLVER);
    Trajectory *run = traced_run(&settled, &REFERENCE_SOLVER);
    assert_close(largest_force(run), largest_force(truth), 1e-6);
    trajectory_destroy(truth);
    trajectory_destroy(run);
}

static void ode_starts_in_it(void **state)
{
    (void)state;
    static const char *const SETTINGS[] = {"contact.resting-speed=50 mm/s", "run.start=settled",
                                           "run.step=10us", "ode.map=impulse",
                                           "ode.stepping=staggered"};
    Scenario scenario = load(CASE, SETTINGS, 5);
    settle_scenario(&scenario);
    kept_hold(scenario.settled.joints);
    Trajectory *truth = traced_run(&scenario, &REFERENCE_SOLVER);
    Trajectory *run = traced_run(&scenario, &ODE_SOLVER);
    const TrajectoryError error = error_against(run, truth, INFINITY);
    assert_true(error.is_known && error.max < 2e-5);
    assert_close(largest_force(run), largest_force(truth), 1e-3);
    trajectory_destroy(truth);
    trajectory_destroy(run);
}

// A run that was not settled, though it is asked for, says so and makes no numbers.
static void no_solver_starts_elsewhere(void **state)
{
    (void)state;
    const Scenario scenario = load_with(CASE, "run.start=settled");
    Trajectory *run = run_scenario(&scenario, &REFERENCE_SOLVER, (RunWatch){.progress = NULL});
    assert_false(run->is_complete);
    assert_non_null(strstr(run->message, "the settled motion is not known"));
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_start_comes_to_one_motion),
        cmocka_unit_test(it_is_what_a_long_run_comes_to),
        cmocka_unit_test(ode_starts_in_it),
        cmocka_unit_test(no_solver_starts_elsewhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

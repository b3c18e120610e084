// Do staggered worlds of different steps, put together, give the order that their number promises,
// in motion and in forces, with a drive and without one?
#include "kept.h"
#include "mechanism.h"
#include "ode_error.h"

#include <stdio.h>
#include <string.h>

static Scenario driven(size_t levels)
{
    Scenario scenario = mechanism_paper();
    scenario.ode.stepping = ODE_EXTRAPOLATED;
    scenario.ode.levels = levels;
    return scenario;
}

static void add_link(Linkage *linkage, const char *name, int above, Vec2 anchor, Body body)
{
    const int number = (int)linkage->body_count++;
    Joint *joint = &linkage->joints[linkage->joint_count++];
    linkage->bodies[number] = body;
    snprintf(linkage->bodies[number].name, LINKAGE_NAME_SIZE, "%s", name);
    snprintf(joint->name, LINKAGE_NAME_SIZE, "%s-pivot", name);
    joint->body_a = above;
    joint->body_b = number;
    joint->anchor_a = anchor;
    joint->anchor_b = (Vec2){above == LINKAGE_GROUND ? -0.25 : -0.2, 0.0};
}

// One or two links, pointing to the right and moving up at the speeds given, rad/s.
static Scenario pendulum(size_t links, double upper_speed, double lower_speed)
{
    Scenario scenario = kept_default();
    Body upper = {.mass = 1.0, .inertia = 0.02, .start.position = {0.25, 0.0}};
    upper.start.omega = upper_speed;
    upper.start.velocity.y = 0.25 * upper_speed;
    add_link(&scenario.linkage, "upper", LINKAGE_GROUND, (Vec2){0.0, 0.0}, upper);
    if (links == 2) {
        Body lower = {.mass = 0.7, .inertia = 0.01, .start.position = {0.7, 0.0}};
        lower.start.omega = lower_speed;
        lower.start.velocity.y = 0.5 * upper_speed + 0.2 * lower_speed;
        add_link(&scenario.linkage, "lower", 0, (Vec2){0.25, 0.0}, lower);
    }
    scenario.run.duration = 1.0;
    scenario.run.samples = 500;
    scenario.ode.stepping = ODE_EXTRAPOLATED;
    return scenario;
}

// The error at a step, against the tightest reference there is where that is the truth.
static TrajectoryError error_at(Scenario scenario, BackendKind truth, double step_s)
{
    scenario.reference.tolerance = 1e-14;
    return ode_error_at(scenario, truth, step_s);
}

// The world steps of a run at a step.
static size_t steps_at(Scenario scenario, double step_s)
{
    scenario.run.step = step_s;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    const size_t steps = ode->steps;
    trajectory_destroy(ode);
    return steps;
}

static double order_between(const Scenario *scenario, BackendKind truth, double step_s)
{
    const double coarse = error_at(*scenario, truth, step_s).max;
    const double fine = error_at(*scenario, truth, 0.5 * step_s).max;
    return ode_order(coarse, fine, 2.0);
}

static void the_order_is_one_more_than_the_levels(void **state)
{
    (void)state;
    // steps at which errors are 1e-6 to 1e-10: above them the next terms show, below them rounding
    const struct {
        size_t levels;
        double step_s;
    } rows[] = {{2, 1e-4}, {2, 2.5e-5}, {3, 1e-4}, {3, 2.5e-5}, {4, 1e-4}, {4, 5e-5}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const Scenario scenario = driven(rows[i].levels);
        const double order = order_between(&scenario, BACKEND_ANALYTIC, rows[i].step_s);
        assert_near(order, (double)rows[i].levels + 1.0, 0.25);
    }
}

static void a_millionth_takes_1200_world_steps_a_turn_and_a_billionth_6000(void **state)
{
    (void)state;
    TrajectoryError error = error_at(driven(4), BACKEND_ANALYTIC, 6e-5);
    assert_true(steps_at(driven(4), 6e-5) <= 1200);
    assert_true(error.max <= 1e-6);
    // one derivative more is one order less, the interval's width being some 0.1 rad of the crank
    assert_true(error.alpha_max <= 2e-5);
    error = error_at(driven(4), BACKEND_ANALYTIC, 2.5e-5);
    assert_true(steps_at(driven(4), 2.5e-5) <= 6000);
    assert_true(error.max <= 1e-9);
    assert_true(error.alpha_max <= 5e-8);
    error = error_at(driven(6), BACKEND_ANALYTIC, 2.5e-5);
    assert_true(steps_at(driven(6), 2.5e-5) <= 6000);
    assert_true(error.max <= 1e-10);
}

// The control: one level less, at the same cost, loses an order.
static void fewer_levels_do_not_reach_as_far_at_the_same_cost(void **state)
{
    (void)state;
    const double two = error_at(driven(2), BACKEND_ANALYTIC, 2.5e-5).max;
    const double three = error_at(driven(3), BACKEND_ANALYTIC, 2.5e-5).max;
    const double four = error_at(driven(4), BACKEND_ANALYTIC, 2.5e-5).max;
    assert_close((double)steps_at(driven(2), 2.5e-5), (double)steps_at(driven(3), 2.5e-5), 0.02);
    assert_true(two > 10.0 * three);
    assert_true(three > 5.0 * four);
}

static void joint_forces_and_drive_are_those_of_inverse_dynamics(void **state)
{
    (void)state;
    Scenario scenario = driven(4);
    scenario.run.step = 2.5e-5;
    scenario.run.revolutions = 0.3;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    Trajectory *analytic = complete_run(&scenario, BACKEND_ANALYTIC);
    for (size_t joint = 0; joint < 4; joint++) {
        const double scale = analytic->joints[joint].force_max.value;
        assert_close(ode->joints[joint].force_max.value, scale, 1e-7);
        for (size_t k = 0; k < ode->sample_count; k++) {
            const JointState *now = trajectory_state(ode, k, joint);
            const JointState *truth = trajectory_state(analytic, k, joint);
            assert_near(now->force_on_b.x, truth->force_on_b.x, 1e-7 * scale);
            assert_near(now->force_on_b.y, truth->force_on_b.y, 1e-7 * scale);
            assert_true(vec2_length(now->eccentricity) < 1e-10);
            assert_true(now->is_touching);
        }
    }
    for (size_t body = 1; body < 3; body++) {
        const BodyExtremes *now = &ode->bodies[body];
        const BodyExtremes *truth = &analytic->bodies[body];
        assert_close(now->omega_max.value, truth->omega_max.value, 1e-5);
        assert_close(now->alpha_max.value, truth->alpha_max.value, 1e-5);
        assert_close(now->alpha_min.value, truth->alpha_min.value, 1e-5);
    }
    // what the drive gave is what the bodies have
    assert_true(fabs(ode->energy.change) > 1.0);
    assert_near(ode->energy.residual, 0.0, 1e-7 * fabs(ode->energy.change));
    assert_string_equal(ode->label, "ode direct/extrapolated/ideal");
    assert_int_equal(ode->constraint_rows, 9);
    trajectory_destroy(ode);
    trajectory_destroy(analytic);
}

// A revolution has 2,400 world steps, the angles of the crank go to 628 rad.
static void a_hundred_turns_leave_no_drift(void **state)
{
    (void)state;
    Scenario scenario = driven(4);
    scenario.run.step = 2.5e-5;
    scenario.run.samples = 360;
    scenario.run.revolutions = 100.0;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    Trajectory *analytic = complete_run(&scenario, BACKEND_ANALYTIC);
    double first = 0.0;
    double last = 0.0;
    double angle = 0.0;
    for (size_t k = 0; k < ode->sample_count; k++) {
        const Motion *now = trajectory_motion(ode, k, 2);
        const Motion *truth = trajectory_motion(analytic, k, 2);
        const double error = fabs(now->omega - truth->omega);
        first = k <= 360 ? fmax(first, error) : first;
        last = k >= 99 * 360 ? fmax(last, error) : last;
        angle = fmax(angle, fabs(now->angle - truth->angle));
    }
    assert_true(first > 0.0);
    assert_true(last <= 1.5 * first);
    assert_true(angle <= 1e-9);
    trajectory_destroy(ode);
    trajectory_destroy(analytic);
}

// Nothing follows from a drive here: the worlds find their start by going back by themselves.
static void a_double_pendulum_has_the_same_orders(void **state)
{
    (void)state;
    const double speeds[][2] = {{0.0, 0.0}, {3.0, -5.0}};
    for (size_t i = 0; i < 2; i++) {
        Scenario scenario = pendulum(2, speeds[i][0], speeds[i][1]);
        scenario.ode.levels = 3;
        assert_near(order_between(&scenario, BACKEND_REFERENCE, 5e-4), 4.0, 0.25);
        scenario.ode.levels = 4;
        assert_near(order_between(&scenario, BACKEND_REFERENCE, 5e-4), 5.0, 0.25);
        const TrajectoryError error = error_at(scenario, BACKEND_REFERENCE, 1.25e-4);
        assert_true(error.max <= 5e-10);
        assert_true(error.angle_max_rad <= 5e-10);
        // the control
        scenario.ode.stepping = ODE_PLAIN;
        assert_true(error_at(scenario, BACKEND_REFERENCE, 1.25e-4).max > 1e-6);
    }
}

// A pendulum let go at the horizontal, its angle -s: omega^2 = 2 m g l sin(s) / J about the pivot.
// The pivot carries gravity and what keeps the centre of mass on its circle.
static void a_pendulums_pivot_force_is_the_closed_forms_from_time_zero_on(void **state)
{
    (void)state;
    Scenario scenario = pendulum(1, 0.0, 0.0);
    scenario.run.step = 2.5e-4;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    const double arm = 0.25;
    const double about_pivot = 0.02 + arm * arm;
    const double g = -scenario.gravity.y;
    for (size_t k = 0; k < ode->sample_count; k++) {
        const double s = -trajectory_motion(ode, k, 0)->angle;
        const double along = arm * 2.0 * g * arm * sin(s) / about_pivot + g * sin(s);
        const double across = g * cos(s) - g * arm * arm * cos(s) / about_pivot;
        assert_near(trajectory_state(ode, k, 0)->force, hypot(along, across), 1e-7);
    }
    // the largest of |alpha| is the first
    assert_near(ode->bodies[0].alpha_min.value, -g * arm / about_pivot, 1e-7);
    assert_true(ode->bodies[0].alpha_min.time_s < 0.9);
    assert_near(ode->energy.change, 0.0, 1e-9);
    assert_true(ode->energy.drive_work == 0.0);
    trajectory_destroy(ode);
}

// Neither the length of an interval nor where samples fall in it matters to what is handed out.
static void few_samples_and_many_show_the_same_motion(void **state)
{
    (void)state;
    Scenario scenario = driven(4);
    scenario.run.step = 5e-5;
    Trajectory *many = complete_run(&scenario, BACKEND_ODE);
    scenario.run.samples = 7;
    Trajectory *few = complete_run(&scenario, BACKEND_ODE);
    assert_int_equal(many->steps, few->steps);
    for (size_t k = 0; k < few->sample_count; k++) {
        const double time_s = few->times[k];
        const size_t near = (size_t)(time_s / many->times[1]);
        const Motion *before = trajectory_motion(many, near, 1);
        const double late_s = time_s - many->times[near];
        const double expected = before->omega + late_s * before->alpha;
        // a parabola's rest over a sample interval: 1e6 rad/s^3
        assert_near(trajectory_motion(few, k, 1)->omega, expected, 1e6 * late_s * late_s + 1e-9);
    }
    trajectory_destroy(many);
    trajectory_destroy(few);
}

static void the_quick_solver_is_reproducible(void **state)
{
    (void)state;
    Scenario scenario = driven(3);
    scenario.run.step = 2e-5;
    scenario.ode.solver = ODE_QUICK;
    scenario.ode.iterations = 200;
    Trajectory *once = complete_run(&scenario, BACKEND_ODE);
    Trajectory *again = complete_run(&scenario, BACKEND_ODE);
    assert_true(once->hash == again->hash);
    assert_true(error_at(scenario, BACKEND_ANALYTIC, 2e-5).max < 1e-2);
    trajectory_destroy(once);
    trajectory_destroy(again);
}

static void play_is_refused(void **state)
{
    (void)state;
    Scenario scenario = driven(4);
    mechanism_loosen(&scenario, "crank-coupler");
    Trajectory *ode = run_scenario(&scenario, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
    assert_false(ode->is_complete);
    assert_non_null(strstr(ode->message, "contacts are not smooth"));
    trajectory_destroy(ode);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_order_is_one_more_than_the_levels),
        cmocka_unit_test(a_millionth_takes_1200_world_steps_a_turn_and_a_billionth_6000),
        cmocka_unit_test(fewer_levels_do_not_reach_as_far_at_the_same_cost),
        cmocka_unit_test(joint_forces_and_drive_are_those_of_inverse_dynamics),
        cmocka_unit_test(a_hundred_turns_leave_no_drift),
        cmocka_unit_test(a_double_pendulum_has_the_same_orders),
        cmocka_unit_test(a_pendulums_pivot_force_is_the_closed_forms_from_time_zero_on),
        cmocka_unit_test(few_samples_and_many_show_the_same_motion),
        cmocka_unit_test(the_quick_solver_is_reproducible),
        cmocka_unit_test(play_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

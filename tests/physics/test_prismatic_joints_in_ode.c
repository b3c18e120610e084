// Are mechanisms with prismatic joints held in ODE as their closed forms have them: motion, forces
// and couples, work of the drive?
#include "ode_error.h"
#include "sliders.h"

#include <string.h>

static double larger(double a, Vec2 b)
{
    return fmax(a, vec2_length(b));
}

// The largest error of all bodies' speeds over the largest of all speeds; rates of angles as m/s at
// 0.1 m. Samples before `from_s` do not count.
static double speed_error(const Sliders *sliders, const Trajectory *run)
{
    static const double ARM = 0.1; // m
    double error = 0.0;
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        Motion truth[SLIDERS_BODY_MAX];
        sliders->motion(&sliders->scenario, run->times[k], truth);
        for (size_t i = 0; i < run->body_count; i++) {
            const Motion *is = trajectory_motion(run, k, i);
            error = larger(error, vec2_sub(is->velocity, truth[i].velocity));
            error = fmax(error, ARM * fabs(is->omega - truth[i].omega));
            largest = fmax(larger(largest, truth[i].velocity), ARM * fabs(truth[i].omega));
        }
    }
    return error / largest;
}

static double error_at(Sliders sliders, OdeStepping stepping, double step_s)
{
    sliders.scenario.ode.stepping = stepping;
    sliders.scenario.run.step = step_s;
    Trajectory *run = complete_run(&sliders.scenario, BACKEND_ODE);
    const double error = speed_error(&sliders, run);
    trajectory_destroy(run);
    return error;
}

// The order at which the error of a mechanism falls from a step to half of it.
static double order_at(const Sliders *sliders, OdeStepping stepping, double step_s)
{
    return ode_order(error_at(*sliders, stepping, step_s),
                     error_at(*sliders, stepping, 0.5 * step_s), 2.0);
}

enum { MECHANISMS = 6 };

static void make_all(Sliders all[MECHANISMS])
{
    all[0] = sliders_crank(true);
    all[1] = sliders_crank(false);
    all[2] = sliders_yoke();
    all[3] = sliders_quick_return();
    all[4] = sliders_bead();
    all[5] = sliders_trammel();
}

// s, at which the orders show, and the error is above rounding's
static const double COARSE_S[MECHANISMS] = {2e-5, 2e-5, 1e-4, 1e-4, 1e-3, 1e-4};

static void staggered_stepping_is_of_second_order(void **state)
{
    (void)state;
    Sliders all[MECHANISMS];
    make_all(all);
    for (size_t i = 0; i < MECHANISMS; i++) {
        assert_near(order_at(&all[i], ODE_STAGGERED, COARSE_S[i]), 2.0, 0.1);
        assert_true(error_at(all[i], ODE_STAGGERED, COARSE_S[i]) < 1e-3);
    }
}

static void extrapolated_stepping_is_of_fifth_order(void **state)
{
    (void)state;
    Sliders all[MECHANISMS];
    make_all(all);
    for (size_t i = 0; i < MECHANISMS; i++) {
        assert_true(order_at(&all[i], ODE_EXTRAPOLATED, COARSE_S[i]) > 4.5);
        assert_true(error_at(all[i], ODE_EXTRAPOLATED, COARSE_S[i]) < 1e-6);
    }
}

// A pair of rows that goes wrong by the tilt it leaves, or by an anchor, is not found by order
// alone: plain stepping too must come to the closed form.
static void plain_stepping_is_of_first_order(void **state)
{
    (void)state;
    Sliders all[MECHANISMS];
    make_all(all);
    for (size_t i = 0; i < MECHANISMS; i++) {
        // from the third halving on the start's error, which goes with the step, too
        const double fine = 0.125 * COARSE_S[i];
        assert_near(order_at(&all[i], ODE_PLAIN, fine), 1.0, 0.35);
        assert_true(error_at(all[i], ODE_PLAIN, fine) < 2e-3);
    }
}

// The control: a crank that is a thousandth longer.
static void a_crank_a_little_longer_is_seen(void **state)
{
    (void)state;
    Sliders crank = sliders_crank(true);
    crank.scenario.linkage.joints[1].anchor_a.x += 5e-5;
    assert_true(error_at(crank, ODE_EXTRAPOLATED, COARSE_S[0]) > 1e-5);
}

// What is missing of Newton's and Euler's equations of all bodies at a time, with the accelerations
// of the closed form, N (moments by 0.1 m).
static double imbalance(const Sliders *sliders, const Trajectory *run, size_t sample)
{
    static const double ARM = 0.1; // m
    const Linkage *linkage = &sliders->scenario.linkage;
    Motion motions[SLIDERS_BODY_MAX];
    Vec2 forces[SLIDERS_BODY_MAX] = {{0.0, 0.0}};
    double moments[SLIDERS_BODY_MAX] = {0.0};
    sliders->motion(&sliders->scenario, run->times[sample], motions);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const JointState *is = trajectory_state(run, sample, i);
        const Vec2 point = linkage_point(motions, joint->body_b, joint->anchor_b);
        for (int side = 0; side < 2; side++) {
            const int body = side == 0 ? joint->body_a : joint->body_b;
            const double sign = side == 0 ? -1.0 : 1.0;
            if (body != LINKAGE_GROUND) {
                const Vec2 arm = vec2_sub(point, motions[body].position);
                forces[body] = vec2_add(forces[body], vec2_scale(sign, is->force_on_b));
                moments[body] += sign * (is->moment_on_b + vec2_cross(arm, is->force_on_b));
            }
        }
    }
    double most = 0.0;
    for (int i = 0; i < (int)linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        const Vec2 needed = vec2_scale(
            body->mass, vec2_add(motions[i].acceleration, scenario_upward(&sliders->scenario)));
        most = larger(most, vec2_sub(needed, forces[i]));
        // the driven body's moment is the drive's
        const bool is_driven = i == linkage_driven_body(linkage);
        most = is_driven ? most
                         : fmax(most, fabs(body->inertia * motions[i].alpha - moments[i]) / ARM);
    }
    return most;
}

static double worst_imbalance(Sliders sliders, OdeStepping stepping, double step_s)
{
    sliders.scenario.ode.stepping = stepping;
    sliders.scenario.run.step = step_s;
    Trajectory *run = complete_run(&sliders.scenario, BACKEND_ODE);
    double most = 0.0;
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        most = fmax(most, imbalance(&sliders, run, k));
        for (size_t i = 0; i < run->joint_count; i++) {
            largest = fmax(largest, trajectory_state(run, k, i)->force);
        }
    }
    trajectory_destroy(run);
    return most / largest;
}

static void forces_and_couples_balance_the_bodies(void **state)
{
    (void)state;
    Sliders all[MECHANISMS];
    make_all(all);
    for (size_t i = 0; i < MECHANISMS; i++) {
        assert_true(worst_imbalance(all[i], ODE_EXTRAPOLATED, COARSE_S[i]) < 1e-5);
        // means over a step, read half a step aside
        assert_true(worst_imbalance(all[i], ODE_STAGGERED, 0.125 * COARSE_S[i]) < 2e-3);
    }
    // the control: a couple about another point
    all[0].scenario.linkage.joints[3].anchor_b.x += 1e-3;
    const double with_joint = worst_imbalance(all[0], ODE_EXTRAPOLATED, COARSE_S[0]);
    assert_true(with_joint < 1e-5); // the joint may be seen from anywhere
    all[0].scenario.linkage.joints[2].anchor_b.y += 1e-4;
    assert_true(worst_imbalance(all[0], ODE_EXTRAPOLATED, COARSE_S[0]) > 1e-4);
}

static void the_guide_holds_with_the_force_and_couple_of_inverse_dynamics(void **state)
{
    (void)state;
    for (int is_ground = 0; is_ground < 2; is_ground++) {
        Sliders crank = sliders_crank(is_ground == 1);
        crank.scenario.ode.stepping = ODE_EXTRAPOLATED;
        crank.scenario.run.step = COARSE_S[0];
        Trajectory *run = complete_run(&crank.scenario, BACKEND_ODE);
        const double sign = is_ground == 1 ? 1.0 : -1.0;
        for (size_t k = 0; k < run->sample_count; k++) {
            const JointState *is = trajectory_state(run, k, 3);
            double force;
            double couple;
            sliders_crank_guide(&crank.scenario, run->times[k], &force, &couple);
            // of some 1000 N and 30 N m
            assert_near(is->force_on_b.x, 0.0, 1e-4);
            assert_near(is->force_on_b.y, sign * force, 1e-3);
            assert_near(is->moment_on_b, sign * couple, 1e-4);
            assert_near(is->eccentricity.y, 0.0, 1e-9);
            assert_near(is->tilt, 0.0, 1e-9);
        }
        trajectory_destroy(run);
    }
}

// The published extremes of the slider's acceleration, m/s^2: at 0 deg, and at 121.9976 deg.
static void the_sliders_acceleration_has_the_published_extremes(void **state)
{
    (void)state;
    Sliders crank = sliders_crank(true);
    crank.scenario.ode.stepping = ODE_EXTRAPOLATED;
    crank.scenario.run.step = 0.5 * COARSE_S[0];
    crank.scenario.run.samples = 3600;
    Trajectory *run = complete_run(&crank.scenario, BACKEND_ODE);
    assert_close(trajectory_motion(run, 0, 2)->acceleration.x, -19419.3605, 1e-8);
    size_t best = 1;
    for (size_t k = 2; k < run->sample_count / 2; k++) {
        best = trajectory_motion(run, k, 2)->acceleration.x >
                       trajectory_motion(run, best, 2)->acceleration.x
                   ? k
                   : best;
    }
    // the top of the parabola through three samples
    const double before = trajectory_motion(run, best - 1, 2)->acceleration.x;
    const double top = trajectory_motion(run, best, 2)->acceleration.x;
    const double behind = trajectory_motion(run, best + 1, 2)->acceleration.x;
    const double slope = 0.5 * (behind - before);
    const double curvature = before - 2.0 * top + behind;
    assert_close(top - 0.5 * slope * slope / curvature, 9695.85572, 1e-8);
    assert_near((double)best - slope / curvature, 1219.976, 0.01);
    trajectory_destroy(run);
}

static double residual_at(Sliders sliders, OdeStepping stepping, double step_s)
{
    sliders.scenario.ode.stepping = stepping;
    sliders.scenario.run.step = step_s;
    Trajectory *run = complete_run(&sliders.scenario, BACKEND_ODE);
    const double residual = fabs(run->energy.residual);
    trajectory_destroy(run);
    return residual;
}

// Not of the trammel, which has no drive: its energy is kept.
static void the_work_of_the_drive_balances_with_the_schemes_orders(void **state)
{
    (void)state;
    Sliders all[MECHANISMS];
    make_all(all);
    for (size_t i = 0; i < MECHANISMS; i++) {
        const double fine = 0.25 * COARSE_S[i];
        const double plain = residual_at(all[i], ODE_PLAIN, fine);
        const double staggered = residual_at(all[i], ODE_STAGGERED, fine);
        assert_true(residual_at(all[i], ODE_PLAIN, 0.5 * fine) < 0.55 * plain);
        assert_true(residual_at(all[i], ODE_STAGGERED, 0.5 * fine) < 0.27 * staggered);
        assert_true(residual_at(all[i], ODE_EXTRAPOLATED, fine) < 0.01 * staggered);
    }
}

// Two sliders on one line hold the same: ODE cannot solve that.
static void redundant_prismatic_joints_are_refused(void **state)
{
    (void)state;
    Sliders crank = sliders_crank(true);
    Linkage *linkage = &crank.scenario.linkage;
    linkage->joints[4] = linkage->joints[3];
    linkage->joints[4].name[0] = 'k';
    linkage->joint_count = 5;
    Trajectory *run = run_scenario(&crank.scenario, registry_solver(BACKEND_ODE), (RunWatch){0});
    assert_false(run->is_complete);
    assert_non_null(strstr(run->message, "2 of the 10 rows of the ideal joints follow"));
    trajectory_destroy(run);
}

static void a_slider_crank_takes_eight_rows(void **state)
{
    (void)state;
    Sliders crank = sliders_crank(true);
    crank.scenario.run.step = 1e-5;
    Trajectory *run = complete_run(&crank.scenario, BACKEND_ODE);
    // two balls, and two rows of the guide
    assert_int_equal(run->constraint_rows, 8);
    trajectory_destroy(run);
}

static void the_quick_solver_holds_them_too(void **state)
{
    (void)state;
    Sliders crank = sliders_crank(true);
    crank.scenario.ode.solver = ODE_QUICK;
    crank.scenario.ode.iterations = 200;
    assert_true(error_at(crank, ODE_STAGGERED, 1e-5) < 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plain_stepping_is_of_first_order),
        cmocka_unit_test(staggered_stepping_is_of_second_order),
        cmocka_unit_test(extrapolated_stepping_is_of_fifth_order),
        cmocka_unit_test(a_crank_a_little_longer_is_seen),
        cmocka_unit_test(forces_and_couples_balance_the_bodies),
        cmocka_unit_test(the_guide_holds_with_the_force_and_couple_of_inverse_dynamics),
        cmocka_unit_test(the_sliders_acceleration_has_the_published_extremes),
        cmocka_unit_test(the_work_of_the_drive_balances_with_the_schemes_orders),
        cmocka_unit_test(redundant_prismatic_joints_are_refused),
        cmocka_unit_test(a_slider_crank_takes_eight_rows),
        cmocka_unit_test(the_quick_solver_holds_them_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

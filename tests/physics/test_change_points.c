// Are linkages of ideal joints followed through change points, where the joints' rows depend on one
// another, and does a run that leaves its branch there say so?
//
// N four-bars in a row, problem A02 of the IFToMM benchmark library: uniform links of 1 m and 1 kg
// from upright with 1 m/s at their tips. On the branch of parallelograms all uprights stand at one
// angle theta from the vertical:
//     theta'' = k sin theta,   k = g 3 (3 N + 1) / (2 (4 N + 1)),   theta(0) = 0, theta'(0) = 1
#include "kept.h"
#include "model/kinematics.h"
#include "ode_error.h"

#include <stdio.h>
#include <string.h>

static const double GRAVITY = 9.81;

static void add_link(Linkage *linkage, const char *kind, Vec2 at, double angle, double omega,
                     double speed)
{
    Body *body = &linkage->bodies[linkage->body_count];
    *body = (Body){.mass = 1.0, .inertia = 1.0 / 12.0};
    snprintf(body->name, sizeof body->name, "%s-%zu", kind, linkage->body_count++);
    body->start =
        (Motion){.position = at, .angle = angle, .velocity = {speed, 0.0}, .omega = omega};
}

static void add_joint(Linkage *linkage, int a, double along_a, int b, double along_b)
{
    Joint *joint = &linkage->joints[linkage->joint_count];
    *joint =
        (Joint){.body_a = a, .body_b = b, .anchor_a = {along_a, 0.0}, .anchor_b = {along_b, 0.0}};
    snprintf(joint->name, sizeof joint->name, "joint-%zu", linkage->joint_count++);
}

// Uprights have the even numbers and point up; couplers the odd ones.
static Scenario four_bars(int count, double duration_s)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    for (int i = 0; i <= count; i++) {
        add_link(linkage, "upright", (Vec2){i, 0.5}, 0.5 * M_PI, -1.0, 0.5);
        if (i < count) {
            add_link(linkage, "coupler", (Vec2){i + 0.5, 1.0}, 0.0, 0.0, 1.0);
        }
        add_joint(linkage, LINKAGE_GROUND, i, 2 * i, -0.5);
        if (i > 0) {
            add_joint(linkage, 2 * i - 1, 0.5, 2 * i, 0.5);
        }
        if (i < count) {
            add_joint(linkage, 2 * i, 0.5, 2 * i + 1, -0.5);
        }
    }
    scenario.gravity = GRAVITY;
    scenario.run.duration = duration_s;
    scenario.run.samples = 100;
    return scenario;
}

// The angle at a time by the classical Runge-Kutta method; 1e-4 s leaves some 1e-13.
static double exact_angle(int count, double time_s)
{
    const double k = GRAVITY * 3.0 * (3.0 * count + 1.0) / (2.0 * (4.0 * count + 1.0));
    const int steps = (int)lround(time_s / 1e-4);
    const double h = time_s / steps;
    double x = 0.0;
    double v = 1.0;
    for (int i = 0; i < steps; i++) {
        const double a1 = k * sin(x);
        const double a2 = k * sin(x + 0.5 * h * v);
        const double a3 = k * sin(x + 0.5 * h * (v + 0.5 * h * a1));
        const double a4 = k * sin(x + h * (v + 0.5 * h * a2));
        x += h * (v + h / 6.0 * (a1 + a2 + a3));
        v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    return x;
}

// How far the tip of any upright is from where theta has it at the end, m.
static double tip_error(const Trajectory *run, double sine, double cosine)
{
    double largest = 0.0;
    for (size_t i = 0; i < run->body_count; i += 2) {
        const double angle = trajectory_motion(run, run->sample_count - 1, i)->angle;
        largest = fmax(largest, hypot(cos(angle) - sine, sin(angle) - cosine));
    }
    return largest;
}

static void the_reference_keeps_the_branch_to_a_billionth(void **state)
{
    (void)state;
    // at 10 s, by a series of order 40 in 50 digits
    const double sines[] = {0.47838505776097056676, 0.32845811154081538952};
    const double cosines[] = {0.87815017879120926825, 0.94451853817860098594};
    for (int count = 1; count <= 2; count++) {
        const Scenario scenario = four_bars(count, 10.0);
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        assert_near(tip_error(run, sines[count - 1], cosines[count - 1]), 0.0, 1e-9);
        // of some 60 J that swing
        assert_near(run->energy.residual, 0.0, 6e-9);
        // the control: the other mechanism
        assert_true(tip_error(run, sines[2 - count], cosines[2 - count]) > 0.1);
        trajectory_destroy(run);
        const double theta = exact_angle(count, 10.0);
        assert_near(hypot(sin(theta) - sines[count - 1], cos(theta) - cosines[count - 1]), 0.0,
                    1e-10);
    }
}

static void seven_four_bars_are_as_many_as_a_linkage_holds(void **state)
{
    (void)state;
    const Scenario scenario = four_bars(7, 1.0);
    assert_true(scenario.linkage.body_count + 2 > KINEMATICS_BODY_MAX);
    const double theta = exact_angle(7, 1.0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_near(tip_error(run, sin(theta), cos(theta)), 0.0, 1e-9);
    trajectory_destroy(run);
}

static double ode_tip_error(int count, OdeStepping stepping, double step_s)
{
    Scenario scenario = four_bars(count, 4.0);
    scenario.ode.stepping = stepping;
    scenario.run.step = step_s;
    const double theta = exact_angle(count, 4.0);
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const double error = tip_error(run, sin(theta), cos(theta));
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
        cmocka_unit_test(seven_four_bars_are_as_many_as_a_linkage_holds),
        cmocka_unit_test(ode_keeps_the_branch_with_its_orders),
        cmocka_unit_test(a_run_that_loses_its_branch_says_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

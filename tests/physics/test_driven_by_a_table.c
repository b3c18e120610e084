// Does a linkage follow a drive whose speed is given over time?
//
// Outside truths: the angle that the areas under the table add up to; the closed form of a
// four-bar, itself against differences of its own positions; inverse dynamics; the order of ODE.
#include "complete_run.h"

#include "mechanism.h"

#include "analytic/closed_form.h"
#include "kept.h"

static const double RPM = 3.14159265358979323846 / 30.0;

// A start from rest, a stretch at constant speed, a reversal and a stop; no time is a multiple of a
// step of the tests.
static Scenario run_up(void)
{
    Scenario scenario = mechanism_paper();
    scenario.linkage.driver.table = (TimeTable){
        .count = 5,
        .times = {0.0, 5.03e-3, 8.011e-3, 13.0007e-3, 17e-3},
        .values = {0.0, 400.0 * RPM, 400.0 * RPM, -200.0 * RPM, 0.0},
    };
    drive_complete(&scenario.linkage.driver);
    const DriveState start = drive_at(&scenario.linkage.driver, 0.0);
    Motion motions[CLOSED_FORM_BODIES];
    assert_true(closed_form_driven(&scenario, &start, motions));
    for (size_t i = 0; i < CLOSED_FORM_BODIES; i++) {
        scenario.linkage.bodies[i].start = motions[i];
    }
    scenario.run.duration = 18e-3;
    scenario.run.samples = 360;
    return scenario;
}

static void the_angle_is_the_area_under_the_speed(void **state)
{
    (void)state;
    const Scenario scenario = run_up();
    const Driver *driver = &scenario.linkage.driver;
    // triangle, rectangle, the way down to rest, the way on to -200 rpm, and back to rest
    const double down_s = (13.0007e-3 - 8.011e-3) * 400.0 / 600.0;
    const double up = 0.5 * 5.03e-3 * 400.0 * RPM + (8.011e-3 - 5.03e-3) * 400.0 * RPM;
    const double most = up + 0.5 * down_s * 400.0 * RPM;
    const double back = 0.5 * (13.0007e-3 - 8.011e-3 - down_s + 17e-3 - 13.0007e-3) * 200.0 * RPM;
    assert_close(drive_angle(driver, 5.03e-3), 0.5 * 5.03e-3 * 400.0 * RPM, 1e-14);
    assert_close(drive_angle(driver, 8.011e-3), up, 1e-14);
    assert_close(drive_angle(driver, 17e-3), most - back, 1e-13);
    assert_close(drive_angle(driver, 1.0), most - back, 1e-13);
    assert_close(drive_extent(driver, 1.0).forth, most, 1e-13);
    assert_near(drive_extent(driver, 1.0).back, 0.0, 0.0);
    const DriveState kink = drive_at(driver, 5.03e-3);
    assert_close(kink.omega, 400.0 * RPM, 1e-14);
    assert_near(kink.alpha, 0.0, 0.0);
    assert_close(drive_since(driver, 1e-3, 5.03e-3).alpha, 400.0 * RPM / 5.03e-3, 1e-14);
}

// The control: without what the drive's acceleration adds the differences are others.
static void closed_form_rates_are_the_differences_of_its_positions(void **state)
{
    (void)state;
    const Scenario scenario = run_up();
    const double width_s = 1e-6;
    const double times[3] = {2e-3, 10e-3, 11.3371e-3}; // the last where it stands still
    for (size_t k = 0; k < 3; k++) {
        Motion motions[3][CLOSED_FORM_BODIES];
        for (int i = 0; i < 3; i++) {
            const DriveState drive =
                drive_at(&scenario.linkage.driver, times[k] + (i - 1) * width_s);
            assert_true(closed_form_driven(&scenario, &drive, motions[i]));
        }
        for (size_t body = 0; body < CLOSED_FORM_BODIES; body++) {
            const double omega = (motions[2][body].angle - motions[0][body].angle) / (2 * width_s);
            const double alpha = (motions[2][body].omega - motions[0][body].omega) / (2 * width_s);
            assert_near(motions[1][body].omega, omega, 1e-5);
            assert_near(motions[1][body].alpha, alpha, 1e-2);
            const double gained =
                (motions[2][body].velocity.y - motions[0][body].velocity.y) / (2 * width_s);
            assert_near(motions[1][body].acceleration.y, gained, 1e-3);
        }
        Motion steady[CLOSED_FORM_BODIES];
        DriveState without = drive_at(&scenario.linkage.driver, times[k]);
        without.alpha = 0.0;
        assert_true(closed_form_driven(&scenario, &without, steady));
        assert_true(fabs(steady[1].alpha - motions[1][1].alpha) > 100.0);
    }
}

static double largest_error(const Trajectory *run, const Trajectory *truth)
{
    double error = 0.0;
    for (size_t sample = 0; sample < truth->sample_count; sample++) {
        for (size_t body = 0; body < truth->body_count; body++) {
            error = fmax(error, fabs(trajectory_motion(run, sample, body)->omega -
                                     trajectory_motion(truth, sample, body)->omega));
        }
    }
    return error;
}

// Of all that the drive gives nothing is lost: the last residual.
static double residual(const Trajectory *run)
{
    return fabs(run->energy.residual) / fabs(run->energy.drive_work);
}

static void the_reference_follows_the_closed_form(void **state)
{
    (void)state;
    Scenario scenario = run_up();
    scenario.reference.tolerance = 1e-13;
    Trajectory *truth = complete_run(&scenario, BACKEND_ANALYTIC);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(largest_error(run, truth) < 1e-12 * 400.0 * RPM);
    assert_true(residual(run) < 1e-9);
    for (size_t sample = 0; sample < truth->sample_count; sample++) {
        for (size_t joint = 0; joint < 4; joint++) {
            const JointState *own = trajectory_state(run, sample, joint);
            const JointState *of = trajectory_state(truth, sample, joint);
            assert_near(own->force_on_b.x, of->force_on_b.x, 1e-8);
            assert_near(own->force_on_b.y, of->force_on_b.y, 1e-8);
        }
    }
    // the drive's work holds the turning of the crank itself: 174e-6 kg m^2 at 400 rpm
    Scenario light = kept_copy(&scenario);
    light.linkage.bodies[0].inertia *= 0.5;
    light.run.duration = scenario.run.duration = 8e-3;
    Trajectory *heavy_run = complete_run(&scenario, BACKEND_REFERENCE);
    Trajectory *light_run = complete_run(&light, BACKEND_REFERENCE);
    const double omega = 400.0 * RPM;
    const double gained = 0.5 * (0.5 * scenario.linkage.bodies[0].inertia) * omega * omega;
    assert_close(heavy_run->energy.drive_work - light_run->energy.drive_work, gained, 1e-9);
    trajectory_destroy(truth);
    trajectory_destroy(run);
    trajectory_destroy(heavy_run);
    trajectory_destroy(light_run);
}

static double error_in_ode(Scenario scenario, const Trajectory *truth, double step_s)
{
    scenario.run.step = step_s;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const double error = largest_error(run, truth);
    trajectory_destroy(run);
    return error;
}

// With play in the last pin but one the coupler hangs on the crank, and its acceleration jumps with
// the crank's. Order 2 gives 1000 at a 32nd of the step, order 1 gives 32.
static void map_impulse_keeps_its_order_across_kinks(void **state)
{
    (void)state;
    Scenario scenario = run_up();
    mechanism_loosen(&scenario, "coupler-follower");
    scenario.contact.stiffness = 3e7;
    scenario.contact.exponent = 1.0;
    scenario.contact.restitution = 0.1;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(residual(truth) < 1e-9);
    const double coarse = error_in_ode(scenario, truth, 40e-6);
    const double fine = error_in_ode(scenario, truth, 1.25e-6);
    assert_true(coarse < 1e-3 * 400.0 * RPM);
    assert_true(coarse / fine > 200.0);
    trajectory_destroy(truth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_angle_is_the_area_under_the_speed),
        cmocka_unit_test(closed_form_rates_are_the_differences_of_its_positions),
        cmocka_unit_test(the_reference_follows_the_closed_form),
        cmocka_unit_test(map_impulse_keeps_its_order_across_kinks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Do sinusoidal loads and drives act as their formula says?
//
// Truths in closed form: a rotor under a torque m + A sin(w t + p),
//     omega = omega_0 + (m t + A / w (cos p - cos(w t + p))) / J
// and the crank of a four-bar whose speed or angle is a sinusoid, with what it takes to turn a disc
// so, J alpha. Controls: another phase, and the same sinusoid in points, are off by more.
#include "complete_run.h"

#include "casefile/casefile.h"
#include "measure/chosen_run.h"
#include "model/common_period.h"
#include "model/loads.h"
#include "run/settle.h"

#include <string.h>

static Scenario scenario_of(const char *text, const char *const *settings, size_t count)
{
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    if (!casefile_load_text("case.yaml", text, strlen(text), settings, count, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return scenario;
}

#define ROTOR                                                                                      \
    "bodies: {rotor: {mass: 1 kg, inertia: 0.02 kg m^2, at: [0 mm, 0 mm]}}\n"                      \
    "joints: {pivot: {between: [ground, rotor], at: [0 mm, 0 mm]}}\n"                              \
    "gravity: 0 m/s^2\n"

static const double J = 0.02;
static const double MEAN = 0.05;
static const double AMPLITUDE = 0.8;
static const double FREQUENCY = 35.0;
static const double PHASE = 0.7;

#define WAVE "{mean: 0.05 N m, amplitude: 0.8 N m, frequency: 35 Hz, phase: 0.7 rad}"

// The same torque as a load, as that of the drive, and as a signal of two loads, half each.
static const char *const TORQUES[] = {
    ROTOR "loads: {shaker: {body: rotor, torque: " WAVE "}}\n"
          "run: {duration: 200 ms, samples: 400, step: 50 us}\n",
    ROTOR "drive: {joint: pivot, torque: " WAVE "}\n"
          "run: {duration: 200 ms, samples: 400, step: 50 us}\n",
    ROTOR "signals: {half: {mean: 0.025 N m, amplitude: 0.4 N m, frequency: 35 Hz, "
          "phase: 0.7 rad}}\n"
          "loads: {one: {body: rotor, torque: half}, other: {joint: pivot, torque: half}}\n"
          "run: {duration: 200 ms, samples: 400, step: 50 us}\n",
};
enum { TORQUE_COUNT = 3 };

static double rotor_omega(double time_s, double phase)
{
    const double w = 2.0 * M_PI * FREQUENCY;
    return (MEAN * time_s + AMPLITUDE / w * (cos(phase) - cos(w * time_s + phase))) / J;
}

static double rotor_error(const Trajectory *run, double phase)
{
    double largest = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        largest = fmax(
            largest, fabs(trajectory_motion(run, i, 0)->omega - rotor_omega(run->times[i], phase)));
    }
    return largest;
}

static void a_torque_swings_a_rotor(void **state)
{
    (void)state;
    for (size_t i = 0; i < TORQUE_COUNT; i++) {
        Scenario scenario = scenario_of(TORQUES[i], NULL, 0);
        Trajectory *reference = complete_run(&scenario, BACKEND_REFERENCE);
        Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
        print_message("# torque %zu: reference off by %.2g, ode by %.2g rad/s\n", i,
                      rotor_error(reference, PHASE), rotor_error(ode, PHASE));
        assert_true(rotor_error(reference, PHASE) < 1e-12);
        // the mean of a step is exact, and so is a rotor's speed
        assert_true(rotor_error(ode, PHASE) < 1e-12);
        // control: a degree of phase
        assert_true(rotor_error(reference, PHASE + M_PI / 180.0) > 1e-3);
        // its work is what the rotor has
        const double omega = trajectory_motion(reference, reference->sample_count - 1, 0)->omega;
        const double work = reference->energy.load_work + reference->energy.drive_work;
        assert_near(work, 0.5 * J * omega * omega, 1e-12);
        trajectory_destroy(reference);
        trajectory_destroy(ode);
        scenario_free(&scenario);
    }
}

// A load of 5 kHz on what would otherwise be a free flight: steps still see it.
static void a_fast_load_is_not_stepped_over(void **state)
{
    (void)state;
    static const char *const SETTINGS[] = {"loads.shaker.torque.frequency=5 kHz"};
    Scenario scenario = scenario_of(TORQUES[0], SETTINGS, 1);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const double w = 1e4 * M_PI;
    double largest = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        const double t = run->times[i];
        const double truth = (MEAN * t + AMPLITUDE / w * (cos(PHASE) - cos(w * t + PHASE))) / J;
        largest = fmax(largest, fabs(trajectory_motion(run, i, 0)->omega - truth));
    }
    print_message("# 5 kHz: off by %.2g of %.2g rad/s\n", largest, AMPLITUDE / w / J);
    assert_true(largest < 1e-10);
    trajectory_destroy(run);
    scenario_free(&scenario);
}

#define FOUR_BAR                                                                                   \
    "four-bar:\n"                                                                                  \
    "  ground:   {length: 254 mm}\n"                                                               \
    "  crank:    {length: 108 mm, mass: 0.12 kg, inertia: 173.92 kg mm^2}\n"                       \
    "  coupler:  {length: 279.4 mm, mass: 0.29 kg, inertia: 2070.46 kg mm^2}\n"                    \
    "  follower: {length: 270.5 mm, mass: 0.28 kg, inertia: 1988.39 kg mm^2}\n"                    \
    "run: {duration: 200 ms, samples: 400, step: 20 us}\n"

// How a crank is to move.
typedef struct Prescribed {
    double angle;
    double omega;
    double alpha;
} Prescribed;

static Prescribed by_speed(double t)
{
    // {mean: 300 rpm, amplitude: 40 rpm, frequency: 12 Hz, phase: 20 deg}
    const double w = 24.0 * M_PI;
    const double a = 40.0 * M_PI / 30.0;
    const double p = M_PI / 9.0;
    return (Prescribed){10.0 * M_PI * t + a / w * (cos(p) - cos(w * t + p)),
                        10.0 * M_PI + a * sin(w * t + p), a * w * cos(w * t + p)};
}

static Prescribed by_angle(double t)
{
    // {amplitude: 25 deg, frequency: 8 Hz, phase: 50 deg}
    const double w = 16.0 * M_PI;
    const double a = 25.0 * M_PI / 180.0;
    const double p = 5.0 * M_PI / 18.0;
    return (Prescribed){a * (sin(w * t + p) - sin(p)), a * w * cos(w * t + p),
                        -a * w * w * sin(w * t + p)};
}

static const struct {
    const char *text;
    Prescribed (*at)(double time_s);
} DRIVES[] = {
    {FOUR_BAR "drive: {start: 30 deg, speed: {mean: 300 rpm, amplitude: 40 rpm, frequency: 12 Hz, "
              "phase: 20 deg}}\n",
     by_speed},
    {FOUR_BAR
     "drive: {start: 30 deg, angle: {amplitude: 25 deg, frequency: 8 Hz, phase: 50 deg}}\n",
     by_angle},
};

static void a_crank_moves_as_its_sinusoid_says(void **state)
{
    (void)state;
    for (size_t k = 0; k < 2; k++) {
        Scenario scenario = scenario_of(DRIVES[k].text, NULL, 0);
        Trajectory *runs[] = {complete_run(&scenario, BACKEND_ANALYTIC),
                              complete_run(&scenario, BACKEND_REFERENCE),
                              complete_run(&scenario, BACKEND_ODE)};
        double off[3] = {0.0};
        double apart[3] = {0.0};
        double alpha_off = 0.0;
        for (size_t i = 0; i < runs[0]->sample_count; i++) {
            const Prescribed truth = DRIVES[k].at(runs[0]->times[i]);
            for (int r = 0; r < 3; r++) {
                const Motion *crank = trajectory_motion(runs[r], i, 0);
                off[r] = fmax(off[r], fabs(crank->omega - truth.omega));
                off[r] = fmax(off[r], fabs(crank->angle - M_PI / 6.0 - truth.angle));
                apart[r] = fmax(apart[r], fabs(trajectory_motion(runs[r], i, 2)->omega -
                                               trajectory_motion(runs[0], i, 2)->omega));
            }
            alpha_off =
                fmax(alpha_off, fabs(trajectory_motion(runs[1], i, 0)->alpha - truth.alpha));
        }
        print_message("# crank %zu: off by %.2g, %.2g, %.2g; follower of the reference %.2g, of "
                      "ode %.2g rad/s from the closed form\n",
                      k, off[0], off[1], off[2], apart[1], apart[2]);
        for (int r = 0; r < 3; r++) {
            assert_true(off[r] < 1e-10);
        }
        assert_true(alpha_off < 1e-7);
        assert_true(apart[1] < 1e-9 && apart[2] < 2e-4);
        // the works of the drive are one
        assert_near(runs[1]->energy.drive_work, runs[0]->energy.drive_work, 1e-7);
        assert_true(fabs(runs[1]->energy.residual) < 1e-9);
        for (int r = 0; r < 3; r++) {
            trajectory_destroy(runs[r]);
        }
        scenario_free(&scenario);
    }
}

// A sinusoid has no kinks: ODE's extrapolated steps keep their order with it, which points do not.
static void extrapolated_steps_are_for_sinusoids_too(void **state)
{
    (void)state;
    static const char *const SETTINGS[] = {"ode.stepping=extrapolated"};
    double errors[3];
    for (int i = 0; i < 3; i++) {
        Scenario scenario = scenario_of(DRIVES[0].text, SETTINGS, 1);
        scenario.run.step = 2e-3 / (1 << i);
        Trajectory *exact = complete_run(&scenario, BACKEND_ANALYTIC);
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        errors[i] = 0.0;
        for (size_t k = 0; k < run->sample_count; k++) {
            errors[i] = fmax(errors[i], fabs(trajectory_motion(run, k, 2)->omega -
                                             trajectory_motion(exact, k, 2)->omega));
        }
        trajectory_destroy(exact);
        trajectory_destroy(run);
        scenario_free(&scenario);
    }
    print_message("# extrapolated: %.2g, %.2g, %.2g rad/s\n", errors[0], errors[1], errors[2]);
    assert_true(errors[1] < errors[0] / 10.0 && errors[2] < errors[1] / 10.0);
}

// The same angle by 31 points of a spline: the control is far off in what matters, the
// acceleration.
static void points_are_no_sinusoid(void **state)
{
    (void)state;
    Scenario exact = scenario_of(DRIVES[1].text, NULL, 0);
    Scenario sampled = exact;
    Driver *driver = &sampled.linkage.driver;
    driver->table = (TimeTable){.count = 31, .period_s = 0.0};
    driver->profile = DRIVE_SPLINE;
    for (size_t i = 0; i < 31; i++) {
        driver->table.times[i] = 0.2 * (double)i / 30.0;
        driver->table.values[i] = by_angle(driver->table.times[i]).angle;
    }
    drive_complete(driver);
    double largest = 0.0;
    double own = 0.0;
    for (int i = 100; i < 900; i++) {
        const double t = 0.2e-3 * i;
        largest = fmax(largest, fabs(drive_at(driver, t).alpha - by_angle(t).alpha));
        own = fmax(own, fabs(drive_at(&exact.linkage.driver, t).alpha - by_angle(t).alpha));
    }
    assert_true(own < 1e-9);
    assert_true(largest > 10.0);
    scenario_free(&exact);
}

// How far a drive goes, and its largest speed: over what a search in small steps finds.
static void a_drive_goes_as_far_as_its_sinusoid(void **state)
{
    (void)state;
    static const double MEANS[] = {0.0, 0.5, 3.0, -0.5, -3.0};
    static const double TIMES[] = {0.05, 0.9, 4.3};
    for (size_t m = 0; m < 5; m++) {
        for (int angles = 0; angles < 2; angles++) {
            Driver driver = {.is_present = true, .has_angles = angles == 1};
            driver.table = (TimeTable){.count = 1, .values = {MEANS[m]}};
            driver.table.wave = (Wave){2.0, 7.0, 0.4};
            driver.table.values[0] = angles == 1 ? -2.0 * sin(0.4) : MEANS[m];
            drive_complete(&driver);
            double speed = 0.0;
            for (size_t i = 0; i < 3; i++) {
                double back = 0.0;
                double forth = 0.0;
                for (int k = 0; k <= 100000; k++) {
                    const double t = TIMES[i] * k / 100000.0;
                    const DriveState at = drive_at(&driver, t);
                    back = fmin(back, at.angle);
                    forth = fmax(forth, at.angle);
                    speed = fmax(speed, fabs(at.omega));
                }
                const DriveExtent extent = drive_extent(&driver, TIMES[i]);
                assert_near(extent.back, back, 1e-7);
                assert_near(extent.forth, forth, 1e-7);
            }
            assert_near(fabs(driver.speed), speed, 1e-6);
            // rates are rates
            const DriveState at = drive_at(&driver, 1.3);
            const double d = 1e-5;
            assert_near((drive_angle(&driver, 1.3 + d) - drive_angle(&driver, 1.3 - d)) / (2.0 * d),
                        at.omega, 1e-7);
            assert_near((drive_at(&driver, 1.3 + d).omega - drive_at(&driver, 1.3 - d).omega) /
                            (2.0 * d),
                        at.alpha, 1e-6);
        }
    }
}

// What acts has a period in common: 50 Hz and 20 Hz 100 ms, with a crank of 300 rpm 200 ms; its own
// sinusoid of 12 Hz on 300 rpm makes whole turns in 1 s; 2^.5 of a frequency makes none.
static void sinusoids_have_periods_in_common(void **state)
{
    (void)state;
    static const char TEXT[] =
        ROTOR "loads:\n"
              "  one: {body: rotor, torque: {amplitude: 1 N m, frequency: 50 Hz}}\n"
              "  other: {body: rotor, torque: {amplitude: 1 N m, frequency: 20 Hz, phase: 1 rad}}\n"
              "run: {duration: 1 s}\n";
    static const char *const ODD[] = {"loads.other.torque.frequency=70.710678 Hz"};
    Scenario scenario = scenario_of(TEXT, NULL, 0);
    assert_near(common_period_find(&scenario.linkage).period_s, 0.1, 1e-12);
    scenario_free(&scenario);
    scenario = scenario_of(TEXT, ODD, 1);
    const CommonPeriod none = common_period_find(&scenario.linkage);
    assert_true(none.period_s == 0.0 && none.is_mismatch);
    assert_non_null(strstr(none.why, "load 'other'"));
    scenario_free(&scenario);
    scenario = scenario_of(DRIVES[0].text, NULL, 0);
    assert_near(common_period_find(&scenario.linkage).period_s, 1.0, 1e-12);
    scenario_free(&scenario);
    scenario = scenario_of(DRIVES[1].text, NULL, 0);
    assert_near(common_period_find(&scenario.linkage).period_s, 0.125, 1e-12);
    scenario_free(&scenario);
}

// A rotor on a spring, near a stop, shaken at 40 Hz: the motion that it settles in
// has that period, and states that are a period apart are the same.
static void a_shaken_motion_settles_by_its_period(void **state)
{
    (void)state;
    static const char TEXT[] =
        ROTOR "loads: {shaker: {body: rotor, torque: {amplitude: 0.5 N m, frequency: 40 Hz}}}\n"
              "torsion-springs: {mount: {joint: pivot, stiffness: 300 N m/rad, damping: 0.4 N m "
              "s/rad}}\n"
              "run: {duration: 50 ms, samples: 100, start: settled}\n";
    static const char *const SETTINGS[] = {"joints.pivot.low=-0.01 deg", "joints.pivot.high=9 deg",
                                           "joints.pivot.stiffness=2e4 N m/rad"};
    Scenario scenario = scenario_of(TEXT, SETTINGS, 3);
    assert_true(scenario_settles(&scenario));
    assert_near(scenario_settling_period(&scenario), 0.025, 1e-12);
    settle_scenario(&scenario, (RunWatch){.progress = NULL});
    if (scenario.settled.motion_count == 0) {
        fail_msg("%s: %s", scenario.settled.message, scenario.run.centred_because);
    }
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    double apart = 0.0;
    double half = 0.0;
    for (size_t i = 0; i < 50; i++) {
        const double omega = trajectory_motion(run, i, 0)->omega;
        apart = fmax(apart, fabs(omega - trajectory_motion(run, i + 50, 0)->omega));
        half = fmax(half, fabs(omega - trajectory_motion(run, i + 25, 0)->omega));
    }
    print_message("# settled: %.2g rad/s from a period later, %.2g from half of one\n", apart,
                  half);
    assert_true(run_impacts(run) >= 2 && apart < 1e-4 * half);
    trajectory_destroy(run);
    scenario_free(&scenario);
}

static void parts_of_signals_have_paths(void **state)
{
    (void)state;
    static const char *const SETTINGS[] = {"signals.half.amplitude=0.6 N m",
                                           "loads.other.torque.phase=90 deg"};
    Scenario scenario = scenario_of(TORQUES[2], SETTINGS, 2);
    const Load *loads = scenario.linkage.loads;
    assert_near(loads[0].table.wave.amplitude, 0.6, 0.0);
    assert_near(loads[1].table.wave.amplitude, 0.6, 0.0);
    assert_near(loads[0].table.wave.phase, 0.7, 0.0);
    assert_near(loads[1].table.wave.phase, 0.5 * M_PI, 1e-15);
    assert_near(load_value(&scenario.linkage, &loads[1], NULL, 0.01, 0.0),
                0.025 + 0.6 * sin(0.7 * M_PI + 0.5 * M_PI), 1e-15);
    scenario_free(&scenario);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_torque_swings_a_rotor),
        cmocka_unit_test(a_fast_load_is_not_stepped_over),
        cmocka_unit_test(a_crank_moves_as_its_sinusoid_says),
        cmocka_unit_test(extrapolated_steps_are_for_sinusoids_too),
        cmocka_unit_test(points_are_no_sinusoid),
        cmocka_unit_test(a_drive_goes_as_far_as_its_sinusoid),
        cmocka_unit_test(sinusoids_have_periods_in_common),
        cmocka_unit_test(a_shaken_motion_settles_by_its_period),
        cmocka_unit_test(parts_of_signals_have_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

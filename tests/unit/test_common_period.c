// What period drives, torques and loads have in common, or why they have none.
#include "load_case.h"

#include "model/common_period.h"
#include "model/scenario.h"

#include <stdio.h>

static Scenario arm(const char *keys)
{
    char text[2048];
    const int length =
        snprintf(text, sizeof text,
                 "bodies:\n"
                 "  arm: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0 m, 0 m]}\n"
                 "  ball: {mass: 1 kg, inertia: 0.01 kg m^2, at: [1 m, 0 m]}\n"
                 "joints:\n"
                 "  pivot: {between: [ground, arm], at: [0 m, 0 m]}\n"
                 "  rail: {between: [ground, ball], at: [1 m, 0 m], along: 90 deg}\n"
                 "  stop: {between: [ground, ball], at-a: [1 m, 0 m], at-b: [1 m, 0 m],\n"
                 "         normal: 90 deg, stiffness: 1e4 N/m}\n"
                 "%s",
                 keys);
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("arm.yaml", text, (size_t)length, NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return scenario;
}

// A load, at most two of which stand in a case.
#define LOAD(name, over, points) "  " name ": {joint: rail, over: " over ", force: " points "}\n"
#define TIMED(name, period)                                                                        \
    LOAD(name, "time, period: " period, "[[0 ms, 0 N], [1 ms, -1 N], [2 ms, 0 N]]")
#define CRANK(name, period)                                                                        \
    LOAD(name, "crank-angle, period: " period, "[[0 deg, 0 N], [90 deg, -1 N], [180 deg, 0 N]]")
#define STEADY "drive: {joint: pivot, speed: 600 rpm}\nloads:\n"
#define BACK                                                                                       \
    "drive: {joint: pivot, period: 60 ms, angle: [[0 ms, 0 deg], [20 ms, 30 deg], [60 ms, 0 "      \
    "deg]]}\nloads:\n"
#define TORQUE "drive: {joint: pivot, torque: [[0 ms, 0 N m], [20 ms, 1 N m]], period: 40 ms}\n"

typedef struct Found {
    const char *keys;
    double period_ms; // 0: none
    const char *why;
} Found;

static const Found FOUND[] = {
    // of the drive, and whole numbers of it
    {STEADY LOAD("gas", "time", "-1 N"), 100.0, NULL},
    {STEADY CRANK("gas", "360 deg"), 100.0, NULL},
    {STEADY CRANK("gas", "720 deg"), 200.0, NULL},
    {STEADY CRANK("gas", "240 deg"), 200.0, NULL},
    {STEADY TIMED("gas", "25 ms"), 100.0, NULL},
    {STEADY TIMED("gas", "150 ms"), 300.0, NULL},
    {STEADY TIMED("gas", "150 ms") CRANK("cam", "720 deg"), 600.0, NULL},
    {BACK TIMED("gas", "40 ms"), 120.0, NULL},
    // a crank that comes back to its start sets no further period
    {BACK CRANK("gas", "700 deg"), 60.0, NULL},
    // without a drive
    {"loads:\n" TIMED("gas", "25 ms"), 25.0, NULL},
    {"loads:\n" TIMED("gas", "20 ms") TIMED("cam", "30 ms"), 60.0, NULL},
    {TORQUE, 40.0, NULL},
    {TORQUE "loads:\n" CRANK("gas", "720 deg"), 40.0, NULL},
    {TORQUE "loads:\n" TIMED("gas", "30 ms"), 120.0, NULL},
    {"drive: {joint: pivot, stall-torque: 1 N m, no-load-speed: 60 rpm}\nloads:\n" TIMED("gas",
                                                                                         "30 ms"),
     30.0, NULL},
    {"drive: {joint: pivot, speed: 600 rpm, stiffness: 1 N m/rad}\nloads:\n" CRANK("gas",
                                                                                   "720 deg"),
     200.0, NULL},
    {"drive: {joint: pivot, speed: 600 rpm, damping: 1 N m s/rad}\nloads:\n" TIMED("gas", "30 ms"),
     30.0, NULL},
    // none
    {"", 0.0, "nothing drives it at a given speed, and no load repeats over time"},
    {"loads:\n" LOAD("gas", "time", "[[0 ms, 0 N], [1 ms, -1 N]]"), 0.0,
     "load 'gas' over time does not repeat"},
    {STEADY CRANK("gas", "none"), 0.0, "load 'gas' over the crank's angle does not repeat"},
    {STEADY TIMED("gas", "33.3 ms"), 0.0,
     "the drive, of period 100 ms, and load 'gas', of 33.3 ms, have no period in common"},
    {"loads:\n" TIMED("gas", "20 ms") TIMED("cam", "20.1 ms"), 0.0,
     "load 'gas', of period 20 ms, and load 'cam', of 20.1 ms, have no period in common"},
    {"drive: {joint: pivot, torque: [[0 ms, 0 N m], [20 ms, 1 N m]]}\n", 0.0,
     "the torque or force of its drive changes without a drive.period"},
    {"drive: {joint: pivot, speed: [[0 ms, 0 rpm], [20 ms, 10 rpm]]}\n", 0.0,
     "the speed of its drive changes without a drive.period"},
    {"drive: {joint: pivot, stall-torque: 1 N m, no-load-speed: 60 rpm}\nloads:\n" CRANK("gas",
                                                                                         "360 deg"),
     0.0, "a torque or force drives it at no given speed, and nothing repeats over time"},
    {"drive: {joint: pivot, speed: 600 rpm, damping: 1 N m s/rad}\n", 0.0,
     "its drive is soft, and turns it at no given speed"},
};

static void periods_are_those_that_all_have(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof FOUND / sizeof *FOUND; i++) {
        Scenario scenario = arm(FOUND[i].keys);
        const CommonPeriod period = common_period_find(&scenario.linkage);
        if (!(fabs(1e3 * period.period_s - FOUND[i].period_ms) <= 1e-9 * FOUND[i].period_ms)) {
            fail_msg("%.12g ms, and %.12g expected, of %s", 1e3 * period.period_s,
                     FOUND[i].period_ms, FOUND[i].keys);
        }
        if (FOUND[i].why != NULL) {
            assert_string_equal(period.why, FOUND[i].why);
            assert_string_equal(scenario.run.centred_because, FOUND[i].why);
            assert_false(scenario_settles(&scenario));
        }
        scenario_free(&scenario);
    }
}

// Its words are a copy's own.
static void the_reason_outlives_the_scenario(void **state)
{
    (void)state;
    Scenario scenario = arm(STEADY TIMED("gas", "33.3 ms"));
    Scenario copy = scenario_copy(&scenario);
    scenario_free(&scenario);
    assert_non_null(strstr(copy.run.centred_because, "have no period in common"));
    scenario_free(&copy);
}

// What runs for less than a period starts as written; a drive of constant speed has to make one
// revolution.
static void a_short_run_starts_as_written(void **state)
{
    (void)state;
    Scenario enough = arm("loads:\n" TIMED("gas", "25 ms") "run: {duration: 25 ms}\n");
    Scenario less = arm("loads:\n" TIMED("gas", "25 ms") "run: {duration: 24.9 ms}\n");
    Scenario one = arm(STEADY CRANK("gas", "720 deg") "run: {revolutions: 1}\n");
    assert_true(scenario_settles(&enough));
    assert_false(scenario_settles(&less));
    assert_string_equal(less.run.centred_because, "it runs for less than a period");
    assert_true(scenario_settles(&one));
    assert_near(scenario_settling_turns(&one), 2.0, 0.0);
    scenario_free(&enough);
    scenario_free(&less);
    scenario_free(&one);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(periods_are_those_that_all_have),
        cmocka_unit_test(the_reason_outlives_the_scenario),
        cmocka_unit_test(a_short_run_starts_as_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

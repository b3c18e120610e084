// Is the largest force that of the motion, whatever the start and however long it takes to settle?
//
// The truths are integrations in other coordinates from 24 to 81 starts, of 200 to 600 periods
// each. The controls are what one start alone, or starts that differ by shares of the drive's
// speed, say after sixteen revolutions.
#include "load_case.h"

#include "run/settle.h"
#include "run/settle_draw.h"

static const char *const RESTING = "contact.resting-speed=300 mm/s"; // the default

static Scenario settled(const char *path, const char *override)
{
    // as long as it takes on a busy machine, too
    const char *overrides[] = {"run.start=settled", RESTING, "run.settle-budget=1000 s", override};
    Scenario scenario = load(path, overrides, override != NULL ? 4 : 3);
    settle_scenario(&scenario, (RunWatch){.progress = NULL});
    kept_settled(&scenario);
    assert_true(scenario.settled.motion_count > 0);
    return scenario;
}

// The first joint with play.
static size_t playing(const Scenario *scenario)
{
    size_t joint = 0;
    while (!linkage_has_play(&scenario->linkage.joints[joint])) {
        joint++;
    }
    return joint;
}

static const SettledNumber *force_of(const Scenario *scenario, size_t motion)
{
    return &scenario->settled.motions[motion].joints[playing(scenario)].force;
}

// The force that one start comes to by itself, that differs by a share of the drive's speed; 0
// where it is said not to repeat.
static double force_alone(const char *path, double size, unsigned member)
{
    const Scenario scenario = load_with(path, RESTING);
    Settling settling = settling_start(&scenario);
    if (member > 0) {
        assert_true(settle_change_start(&settling.scenario, size, member));
    }
    Err err = {ERR_NONE, ""};
    assert_true(settling_run(&settling, 1e-7, 100, &err));
    double force = 0.0;
    if (settling.period > 0) {
        double values[SETTLE_PERIOD_MAX];
        const size_t number = settle_joint_number(playing(&scenario), SETTLE_FORCE);
        const size_t count = settling_numbers(&settling, number, values);
        for (size_t i = 0; i < count; i++) {
            force = fmax(force, values[i]);
        }
    }
    settling_finish(&settling);
    return force;
}

// A cam settles after 14 to 85 revolutions, in one motion.
static void a_long_transient_is_waited_for(void **state)
{
    (void)state;
    static const char *const CAM = "tests/settled/cam.yaml";
    const Scenario cam = settled(CAM, NULL);
    assert_int_equal(cam.settled.motion_count, 1);
    assert_int_equal(cam.settled.motions[0].period, 1);
    assert_int_equal(cam.settled.motions[0].starts, 16);
    assert_close(force_of(&cam, 0)->headline, 7500.6, 1e-4);
    // the control: after sixteen revolutions or more it seems not to repeat
    assert_true(force_alone(CAM, 0.05, 2) == 0.0);
}

// Gears under a transmission error have a quiet motion and a louder one.
static void the_louder_of_two_motions_is_found(void **state)
{
    (void)state;
    static const char *const GEARS = "tests/settled/gears-80.yaml";
    const Scenario gears = settled(GEARS, NULL);
    assert_int_equal(gears.settled.motion_count, 2);
    assert_close(force_of(&gears, 0)->headline, 0.333293, 1e-4);
    assert_close(force_of(&gears, 1)->headline, 0.187447, 1e-4);
    // 70 of 81 starts came to the first
    assert_true(gears.settled.motions[0].share_low < 70.0 / 81.0);
    assert_true(gears.settled.motions[0].share_high > 0.5);
    // the control: starts beside the written one come to the quiet one
    static const double SIZES[] = {0.0, 0.05, 0.2, 0.01};
    for (unsigned i = 0; i < 4; i++) {
        assert_close(force_alone(GEARS, SIZES[i], i), 0.187447, 1e-3);
    }
}

// A change that shrinks to 0.73 of itself in a period is no chaos.
static void a_slow_decay_repeats(void **state)
{
    (void)state;
    const Scenario gears = settled("tests/settled/gears-100.yaml", NULL);
    assert_int_equal(gears.settled.motion_count, 1);
    assert_int_equal(gears.settled.motions[0].period, 1);
    assert_int_equal(gears.settled.motions[0].starts, 16);
}

// The 95 % quantile of 280 revolutions from 8 starts is 3392 N.
static void what_does_not_repeat_has_the_quantile_of_long_runs(void **state)
{
    (void)state;
    const double truth = 3392.0; // N
    const char *overrides[] = {"run.start=settled",    RESTING,
                               "drive.speed=1200 rpm", "run.settle-starts=8",
                               "run.settle-least=120", "run.settle-budget=1000 s"};
    Scenario scenario = load("tests/settled/wrist-pin.yaml", overrides, 6);
    settle_scenario(&scenario, (RunWatch){.progress = NULL});
    kept_settled(&scenario);
    const SettledNumber *force = force_of(&scenario, 0);
    assert_int_equal(scenario.settled.motions[0].period, 0);
    assert_true(scenario.settled.motions[0].watched >= 120);
    assert_true(force->low <= truth && truth <= force->high);
    assert_true(force->high - force->low < 0.2 * force->headline);
    // the control: the median, which was the first number on the screen, is far from it
    assert_true(force->median_high < 0.6 * truth);
}

// Peaks that are right to a thousandth need no digits of the state: two worn pins with friction
// come to them within a few revolutions, and to no more for a hundred.
static void what_repeats_to_its_peaks_is_settled(void **state)
{
    (void)state;
    const Scenario press = settled("tests/settled/press.yaml", NULL);
    assert_int_equal(press.settled.motion_count, 1);
    assert_int_equal(press.settled.motions[0].period, 1);
    assert_true(press.settled.revolutions < 40);
    assert_close(force_of(&press, 0)->headline, 29.07e3, 1e-3);
}

// Starts that a budget ends on their way to a motion are no other motion, but undecided.
static void what_the_budget_ends_is_no_motion(void **state)
{
    (void)state;
    const Scenario press = settled("tests/settled/press.yaml", "run.settle-budget=1.2 s");
    assert_true(press.settled.is_spent);
    assert_true(press.settled.starts < press.settled.tried);
    assert_true(press.settled.motion_count == 1 || press.settled.motions[0].period == 0);
}

// No two starts are alike, also where there is one freedom.
static void starts_are_different(void **state)
{
    (void)state;
    enum { STARTS = 15 };
    const Scenario cam = load("tests/settled/cam.yaml", NULL, 0);
    const int follower = linkage_find_body(&cam.linkage, "follower");
    SettleReach reach[3] = {[2] = {.gap = 1e-2, .approach = 2.0}};
    Motion starts[STARTS];
    for (size_t i = 0; i < STARTS; i++) {
        Scenario drawn = scenario_copy(&cam);
        assert_true(settle_draw(&drawn, reach, i, STARTS + 1));
        starts[i] = drawn.linkage.bodies[follower].start;
        for (size_t k = 0; k < i; k++) {
            assert_true(fabs(starts[k].velocity.y - starts[i].velocity.y) > 1e-2 ||
                        fabs(starts[k].position.y - starts[i].position.y) > 1e-4);
        }
        // they stay in what the play allows: no deeper than the cam, no higher than it goes
        assert_true(starts[i].position.y >= 40e-3 - 1e-9);
        assert_true(starts[i].position.y <= 40e-3 + 1e-2 + 1e-9);
        assert_true(fabs(starts[i].velocity.y) <= 2.0 + 1e-9);
        scenario_free(&drawn);
    }
}

// Without any loss a motion never forgets its start.
static void nothing_settles_without_a_loss(void **state)
{
    (void)state;
    const char *overrides[] = {"run.start=settled", "contact.restitution=1"};
    Scenario scenario = load("tests/settled/wrist-pin.yaml", overrides, 2);
    settle_scenario(&scenario, (RunWatch){.progress = NULL});
    kept_settled(&scenario);
    assert_int_equal(scenario.settled.motion_count, 0);
    assert_int_equal(scenario.run.start, START_CENTRED);
    assert_non_null(strstr(scenario.run.centred_because, "dissipates"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_long_transient_is_waited_for),
        cmocka_unit_test(the_louder_of_two_motions_is_found),
        cmocka_unit_test(a_slow_decay_repeats),
        cmocka_unit_test(what_does_not_repeat_has_the_quantile_of_long_runs),
        cmocka_unit_test(what_repeats_to_its_peaks_is_settled),
        cmocka_unit_test(what_the_budget_ends_is_no_motion),
        cmocka_unit_test(starts_are_different),
        cmocka_unit_test(nothing_settles_without_a_loss),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

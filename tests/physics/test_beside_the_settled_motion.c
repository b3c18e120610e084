// Is what is said beside a settled motion right to the digits that are shown of it?
//
// Other damping is found at a tolerance that those digits need. The truth is the same case with
// that damping, turned at the tolerance of the settled motion itself until it repeats to 1e-7, or,
// where it does not, for many more revolutions. The controls are a tolerance that is too loose, and
// the damping as it is. Cases are those shipped, and the paper's with seeded play and speed.
#define _GNU_SOURCE // sched_setaffinity
#include "casefile/casefile.h"
#include "close.h"

#include "base/lcg.h"
#include "base/sorted.h"
#include "run/settle.h"

#include <sched.h>
#include <stdio.h>
#include <string.h>

static const RunWatch NOBODY = {.progress = NULL};
static const char *const PAPER = "cases/paper/impact-k66.yaml";
static const char *const STACKUP = "cases/paper/stackup-impact.yaml";
static const char *const COMPRESSOR = "cases/mechanisms/compressor.yaml";

// Half a unit of the fourth digit, at its largest.
static const double SHOWN = 5e-5;

static Scenario settled_case(const char *path, const char *const *overrides, size_t count)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load(path, overrides, count, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    settle_scenario(&scenario, NOBODY);
    if (scenario.settled.motion_count == 0) {
        fail_msg("%s", scenario.settled.message);
    }
    return scenario;
}

// The largest force of all joints over the last period, N.
static double largest_of(const Settling *settling)
{
    double largest = 0.0;
    for (size_t k = settling->count - settling->period; k < settling->count; k++) {
        for (size_t i = 0; i < settling->scenario.linkage.joint_count; i++) {
            largest = fmax(largest,
                           settling->revolutions[k].numbers[settle_joint_number(i, SETTLE_FORCE)]);
        }
    }
    return largest;
}

// The same of a scenario with that share of its damping from its settled motion on, at that
// tolerance of the reference; 0 where it does not repeat.
static double truth_of(const Scenario *scenario, double scale, double reference)
{
    enum { MOST = 40 };
    Settling settling = settling_start(scenario);
    settling.scenario.contact.damping_scale *= scale;
    settling.scenario.reference.tolerance = reference;
    Err err = {0};
    assert_true(settling_run(&settling, 1e-7, MOST, &err));
    const double force = settling.period > 0 ? largest_of(&settling) : 0.0;
    settling_finish(&settling);
    return force;
}

static double shown_of(const Scenario *scenario, const SettledMotion *motion)
{
    double largest = 0.0;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        largest = fmax(largest, motion->joints[i].force.headline);
    }
    return largest;
}

// Of half and twice the damping, those that repeat; returns how many that are.
static size_t shown_are_right(const char *path, const char *const *overrides, size_t count)
{
    Scenario scenario = settled_case(path, overrides, count);
    settle_damping(&scenario, NOBODY);
    const SettledMotion *const found[] = {&scenario.settled.halved, &scenario.settled.doubled};
    static const double SCALES[] = {0.5, 2.0};
    size_t repeating = 0;
    for (size_t i = 0; i < 2; i++) {
        const double shown = shown_of(&scenario, found[i]);
        if (found[i]->period > 0) {
            assert_close(shown, truth_of(&scenario, SCALES[i], 1e-10), SHOWN);
            repeating++;
        }
    }
    scenario_free(&scenario);
    return repeating;
}

static void other_damping_has_the_digits_shown(void **state)
{
    (void)state;
    assert_int_equal(shown_are_right(STACKUP, NULL, 0), 1);
    assert_int_equal(shown_are_right(PAPER, NULL, 0), 1);
    assert_int_equal(shown_are_right(COMPRESSOR, NULL, 0), 2);
}

static void other_damping_of_random_cases_has_them_too(void **state)
{
    (void)state;
    enum { CASES = 4 };
    uint64_t seed = 37;
    size_t repeating = 0;
    for (int k = 0; k < CASES; k++) {
        char hole[80];
        char speed[80];
        snprintf(hole, sizeof hole, "joints.crank-coupler.hole=%.4f mm",
                 9.986 + 0.02 + 0.015 * (1.0 + lcg_draw(&seed)));
        snprintf(speed, sizeof speed, "drive.speed=%.1f rpm",
                 600.0 + 300.0 * (1.0 + lcg_draw(&seed)));
        const char *const overrides[] = {hole, speed};
        repeating += shown_are_right(PAPER, overrides, 2);
    }
    assert_true(repeating >= CASES);
}

// The controls: at a loose tolerance the digits are others, and so they are with other damping.
static void a_loose_tolerance_would_show_other_digits(void **state)
{
    (void)state;
    Scenario scenario = settled_case(PAPER, NULL, 0);
    const double truth = truth_of(&scenario, 2.0, 1e-10);
    const double loose = truth_of(&scenario, 2.0, 1e-6);
    assert_true(truth > 0.0);
    assert_true(fabs(loose / truth - 1.0) > SHOWN);
    assert_true(fabs(shown_of(&scenario, &scenario.settled.motions[0]) / truth - 1.0) > SHOWN);
    scenario_free(&scenario);
}

// Half the damping of this case does not repeat. Its median is that of forty revolutions as exact
// as the settled motion, to three standard errors of the two; that of twice the damping is not.
static void what_does_not_repeat_has_the_median_of_many_revolutions(void **state)
{
    (void)state;
    enum { MANY = 40, FIRST = 4, COUNTED = 8 };
    Scenario scenario = settled_case(STACKUP, NULL, 0);
    settle_damping(&scenario, NOBODY);
    const SettledMotion *halved = &scenario.settled.halved;
    assert_int_equal(halved->period, 0);
    assert_int_equal(halved->starts, 1);
    Settling settling = settling_start(&scenario);
    settling.scenario.contact.damping_scale *= 0.5;
    double forces[MANY];
    double sum = 0.0;
    double squares = 0.0;
    Err err = {0};
    for (size_t k = 0; k < MANY; k++) {
        assert_true(settling_turn(&settling, &err));
        settling.period = 1;
        forces[k] = largest_of(&settling);
        sum += k < FIRST ? 0.0 : forces[k];
        squares += k < FIRST ? 0.0 : forces[k] * forces[k];
    }
    const double counted = MANY - FIRST;
    const double mean = sum / counted;
    const double spread = sqrt(squares / counted - mean * mean);
    // of a median, in the spread of one force
    const double error = 1.2533 * spread * sqrt(1.0 / counted + 1.0 / COUNTED);
    sorted_make(forces + FIRST, MANY - FIRST);
    const double median = sorted_median(forces + FIRST, MANY - FIRST);
    assert_true(fabs(shown_of(&scenario, halved) - median) < 3.0 * error);
    assert_true(fabs(shown_of(&scenario, &scenario.settled.doubled) - median) > 3.0 * error);
    assert_true(halved->joints[0].force.low <= halved->joints[0].force.high);
    settling_finish(&settling);
    scenario_free(&scenario);
}

static void assert_same_motion(const Scenario *scenario, const SettledMotion *a,
                               const SettledMotion *b)
{
    assert_int_equal(a->starts, b->starts);
    assert_int_equal(a->period, b->period);
    assert_memory_equal(&a->change, &b->change, sizeof a->change);
    assert_memory_equal(a->joints, b->joints, scenario->linkage.joint_count * sizeof *a->joints);
}

static Scenario all_of(const char *path)
{
    Scenario scenario = settled_case(path, NULL, 0);
    settle_beside(&scenario, NOBODY);
    return scenario;
}

// One processor and all of them come to the same bits; so do both searches one after the other.
static void processors_change_no_number(void **state)
{
    (void)state;
    cpu_set_t before;
    cpu_set_t one;
    assert_int_equal(sched_getaffinity(0, sizeof before, &before), 0);
    Scenario many = all_of(PAPER);
    CPU_ZERO(&one);
    for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; i++) {
        if (CPU_ISSET(i, &before)) {
            CPU_SET(i, &one);
        }
    }
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    Scenario single = settled_case(PAPER, NULL, 0);
    settle_growth(&single, NOBODY);
    settle_damping(&single, NOBODY);
    assert_int_equal(sched_setaffinity(0, sizeof before, &before), 0);
    assert_same_motion(&many, &many.settled.motions[0], &single.settled.motions[0]);
    assert_same_motion(&many, &many.settled.halved, &single.settled.halved);
    assert_same_motion(&many, &many.settled.doubled, &single.settled.doubled);
    assert_memory_equal(&many.settled.growth.factor, &single.settled.growth.factor, sizeof(double));
    assert_memory_equal(many.linkage.bodies, single.linkage.bodies,
                        many.linkage.body_count * sizeof *many.linkage.bodies);
    scenario_free(&many);
    scenario_free(&single);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(other_damping_has_the_digits_shown),
        cmocka_unit_test(other_damping_of_random_cases_has_them_too),
        cmocka_unit_test(a_loose_tolerance_would_show_other_digits),
        cmocka_unit_test(what_does_not_repeat_has_the_median_of_many_revolutions),
        cmocka_unit_test(processors_change_no_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

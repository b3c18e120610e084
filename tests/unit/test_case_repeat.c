// Is a case that is read once for many scenarios the case that is read anew for each?
//
// The truth is casefile_load_text, which keeps nothing: the same scenario bit for bit, or the same
// error to the last character. The overrides of each round are drawn at random from values that are
// right, out of range, of another unit or kind, or that YAML takes for more than themselves. Runs
// in the source root.
#include "same_scenario.h"
#include "sample.h"

#include "base/lcg.h"

#include <stdio.h>
#include <stdlib.h>

enum { ROUNDS = 2000, MOST = 4, VALUES = 8, TEXT_SIZE = 100, CASE_SIZE = 8192 };

typedef struct Key {
    const char *name;
    const char *values[VALUES];
} Key;

static const Key KEYS[] = {
    {"drive.speed",
     {"1000 rpm", "104.7197551196598 rad/s", "-3 rpm", "0 rpm", "5 mm", "'900 rpm'", "1e3 rpm # x",
      "[[0 s, 1 rpm], [1 s, 2 rpm]]"}},
    {"four-bar.coupler.length",
     {"279.4 mm", "0.28 m", "279 +- 0.2 mm", "10 mm", "2 km", "279.4  mm", "-", "{a: b}"}},
    {"joints.crank-coupler.hole",
     {"10.015 mm", "10.02 mm", "9 mm", "1.002e-2 m", "!tag 1", "*one", "10.015 mm ", "--- 1 mm"}},
    {"joints.crank-coupler.radial-clearance",
     {"15 um", "1.5e-05 m", "0 mm", "15", "nan m", "-1 um", "? x", "- 1 um"}},
    {"contact.damping",
     {"flores", "none", "hu-guo", "floress", "null", "~", "viscous", "\"none\""}},
    {"contact.stiffness",
     {"6.6e10 N/m^1.5", "1e7 N/m", "66 N/mm^1.5", "none", "1 N", "a: b", "a:b", "@x"}},
    {"run.step", {"1 us", "auto", "2e-06 s", "1 h", "0 s", "1 us, 2 us", "%1", "1 us\t"}},
    {"run.revolutions", {"0.5", "1", "2.5", "0", "x", "1 revolution", "\"", "`1"}},
    {"ode.map", {"impulse", "midpoint", "textbook", "corrected", "map", "| x", "&a x", "im pulse"}},
    {"no.such-key", {"1", "2", "3", "4", "5", "6", "7", "8"}},
};
enum { KEY_COUNT = sizeof KEYS / sizeof KEYS[0] };

static char text[CASE_SIZE];
static size_t size;

static int read_case(void **state)
{
    (void)state;
    FILE *file = fopen("cases/paper/stackup-impact.yaml", "rb");
    if (file == NULL) {
        return -1;
    }
    size = fread(text, 1, sizeof text, file);
    fclose(file);
    return size > 0 && size < sizeof text ? 0 : -1;
}

static size_t pick(uint64_t *seed, size_t count)
{
    return (size_t)(0.5 * (lcg_draw(seed) + 1.0) * (double)count);
}

// What a round has in place of the last one's: mostly other values of the same keys, of which the
// one that is no key is rare.
static void draw(uint64_t *seed, size_t round, size_t keys[MOST], size_t *count,
                 char overrides[MOST][TEXT_SIZE])
{
    if (round % 20 == 0) {
        *count = pick(seed, MOST + 1);
        for (size_t i = 0; i < *count; i++) {
            keys[i] = pick(seed, KEY_COUNT - (round % 100 == 0 ? 0 : 1));
        }
    }
    for (size_t i = 0; i < *count; i++) {
        // values that make a case are drawn as often as all others together
        const size_t value = pick(seed, pick(seed, 2) == 0 ? 2 : VALUES);
        snprintf(overrides[i], TEXT_SIZE, "%s=%s", KEYS[keys[i]].name, KEYS[keys[i]].values[value]);
    }
}

static void a_repeated_case_is_the_case_read_anew(void **state)
{
    (void)state;
    CasefileRepeat *repeat = casefile_repeat_open("stackup.yaml", text, size, false);
    uint64_t seed = 37;
    size_t keys[MOST], count = 0, good = 0, wrong = 0;
    const size_t rounds = sample_size(ROUNDS);
    for (size_t round = 0; round < rounds; round++) {
        char overrides[MOST][TEXT_SIZE];
        draw(&seed, round, keys, &count, overrides);
        const char *const all[MOST] = {overrides[0], overrides[1], overrides[2], overrides[3]};
        Scenario own, truth;
        Err err = {0}, expected = {0};
        const bool is_good =
            casefile_load_text("stackup.yaml", text, size, all, count, &truth, &expected);
        assert_int_equal(casefile_repeat(repeat, all, count, &own, &err), is_good);
        assert_int_equal(err.kind, expected.kind);
        assert_string_equal(err.text, expected.text);
        if (is_good) {
            assert_same_scenario(&own, &truth);
            scenario_free(&own);
            scenario_free(&truth);
        }
        good += is_good ? 1 : 0;
        wrong += is_good ? 0 : 1;
    }
    // both ends were met often
    assert_true(good > rounds / 10 && wrong > rounds / 10);
    casefile_repeat_close(repeat);
}

// The control: what the repeated case is compared by sees the least change of a value.
static void another_value_makes_another_scenario(void **state)
{
    (void)state;
    static const char *const VALUES_OF_SPEED[] = {"drive.speed=104.71 rad/s",
                                                  "drive.speed=104.71000000000002 rad/s"};
    CasefileRepeat *repeat = casefile_repeat_open("stackup.yaml", text, size, false);
    Scenario made[2];
    Err err = {0};
    for (size_t i = 0; i < 2; i++) {
        assert_true(casefile_repeat(repeat, &VALUES_OF_SPEED[i], 1, &made[i], &err));
    }
    assert_true(made[0].linkage.driver.speed != made[1].linkage.driver.speed);
    assert_false(same_body(&made[0].linkage.bodies[0], &made[1].linkage.bodies[0]));
    scenario_free(&made[0]);
    scenario_free(&made[1]);
    casefile_repeat_close(repeat);
    casefile_repeat_close(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_repeated_case_is_the_case_read_anew),
        cmocka_unit_test(another_value_makes_another_scenario),
    };
    return cmocka_run_group_tests_name("case_repeat", tests, read_case, NULL);
}

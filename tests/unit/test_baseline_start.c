// Does a check begin a case that settles where its baseline's numbers did, on whatever processor,
// and nowhere else?
#include "load_case.h"

#include "commands/check/baseline.h"
#include "commands/check/setting_agrees.h"

// The shipped cases whose baselines hold a start.
static const char *const SETTLED[][2] = {
    {"cases/mechanisms/pin-coupling.yaml", "results/baseline/pin-coupling.json"},
    {"cases/mechanisms/shaken-lever.yaml", "results/baseline/shaken-lever.json"},
    {"cases/paper/stackup-impact.yaml", "results/baseline/stackup-impact.json"},
};
enum { SETTLED_COUNT = sizeof SETTLED / sizeof *SETTLED };

static bool begins_as(const char *path, const char *case_path, const char *const *set, size_t count)
{
    Scenario scenario;
    Err err = {0};
    assert_true(casefile_load(case_path, set, count, &scenario, &err));
    scenario = kept_instead(&scenario);
    Baseline was = {.settings = NULL};
    Baseline now = {.settings = NULL};
    assert_true(baseline_json_read(path, &was, &err));
    baseline_begin(&now, &scenario);
    const bool begins = baseline_start_scenario(&was, &now, &scenario);
    baseline_finish(&was);
    baseline_finish(&now);
    return begins;
}

// A baseline of before a key was added has another list: its case is settled anew each time, which
// no number shows on the machine that made it.
static void shipped_baselines_hold_the_start_of_their_cases(void **state)
{
    (void)state;
    for (size_t i = 0; i < SETTLED_COUNT; i++) {
        assert_true(begins_as(SETTLED[i][1], SETTLED[i][0], NULL, 0));
    }
    const char *const faster[] = {"drive.speed=999 rpm"};
    assert_false(begins_as("results/baseline/stackup-impact.json",
                           "cases/paper/stackup-impact.yaml", faster, 1));
}

// 0.017320508075688773 is 0.01 sqrt(3) as one library has it, the number before that of another.
static void numbers_agree_to_rounding_and_words_as_they_are(void **state)
{
    (void)state;
    assert_true(setting_agrees("0.01, 0.017320508075688773 m", "0.01, 0.017320508075688770 m"));
    assert_true(setting_agrees("1 m, 1e-17 m", "1 m, -2e-17 m"));
    assert_true(setting_agrees("lankarani-nikravesh", "lankarani-nikravesh"));
    assert_false(setting_agrees("0.01, 0.017320508075688773 m", "0.01, 0.0173205081 m"));
    assert_false(setting_agrees("0.01 m", "0.01 rad"));
    assert_false(setting_agrees("ground, crank", "ground, crank-2"));
    assert_false(setting_agrees("pin-1", "pin-2"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shipped_baselines_hold_the_start_of_their_cases),
        cmocka_unit_test(numbers_agree_to_rounding_and_words_as_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Does the C code that `jointplay tune` writes give the same run by itself, bit for bit?
//
// Each run here stands for several parts of the code: every map and stepping, both solvers of ODE,
// every collider, the extrapolated steps of ideal joints and the step that is chosen are in one of
// them.
#include "program.h"

// its contacts are all in the first degrees
#define CASE "$cases/paper/impact-k66.yaml --set run.revolutions=0.2"
#define K66  CASE " --error 3e-2"
// a polygon is not the round hole, however fine its facets and the step
#define FACETS CASE " --set ode.facets=64 --error 0.2 "

static const char *words(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    assert_non_null(text);
    return text;
}

// Compiles the code by the command in it, with ODE (and libccd) alone and not a warning, runs it,
// and holds it against the program.
static void check_code(Program *program, const char *options)
{
    char line[3 * PROGRAM_PATH_SIZE];
    char with_code[PROGRAM_PATH_SIZE];
    snprintf(with_code, sizeof with_code, "tune %s --one-file setting.c --json --quiet", options);
    program_run(program, with_code);
    if (program->status != 0) {
        fail_msg("%s: status %d: %s", with_code, program->status, program->errors);
    }
    json_t *root = program_json(program);
    const char *command = words(json_object_get(root, "cheapest"), "command");
    snprintf(line, sizeof line,
             "cd '%s' && libraries=$(grep -o -m 1 -e '-lode[^&]*' setting.c) && "
             "$JOINTPLAY_CC -Wall -Werror -o setting setting.c $libraries && "
             "./setting >setting.csv 2>words",
             program->folder);
    assert_int_equal(system(line), 0);
    snprintf(line, sizeof line, "%s --set 'run.backends=[ode]' --series own.csv --quiet",
             strchr(command, ' ') + 1);
    program_run(program, line);
    assert_int_equal(program->status, 0);
    // every sample; what happens between them is kept by `run` alone
    snprintf(line, sizeof line,
             "cd '%s' && columns=$(head -n 1 setting.csv | tr , '\\n' | wc -l) && "
             "cut -d, -f\"1-$columns\" own.csv >samples.csv && cmp setting.csv samples.csv",
             program->folder);
    assert_int_equal(system(line), 0);
    // the run as a whole, not only its samples
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "words", path);
    program_read(path, program->errors);
    assert_says(program->errors, words(json_object_get(root, "cheapest"), "hash"));
    json_decref(root);
}

static void check_codes(void **state, const char *const runs[], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        check_code(*state, runs[i]);
    }
}

static void the_code_gives_the_same_run_bit_for_bit(void **state)
{
    static const char *const RUNS[] = {
        K66 " --schemes quick/staggered/impulse",
        K66 " --schemes auto",
        "$cases/literature/pin-in-hole-drop.yaml --error 1e-2 --schemes direct/plain/corrected",
    };
    check_codes(state, RUNS, sizeof RUNS / sizeof *RUNS);
}

static void the_code_of_limited_joints_too(void **state)
{
    static const char *const RUNS[] = {
        "$cases/mechanisms/gear-pair.yaml --error 1e-2 --schemes direct/staggered/impulse",
        "$cases/mechanisms/stop-rebound.yaml --error 2e-1 --schemes quick/staggered/midpoint",
    };
    check_codes(state, RUNS, sizeof RUNS / sizeof *RUNS);
}

static void the_code_of_ideal_joints_too(void **state)
{
    static const char *const RUNS[] = {
        "$cases/paper/ideal-nominal.yaml --error 1e-3 --schemes extrapolated",
    };
    check_codes(state, RUNS, sizeof RUNS / sizeof *RUNS);
}

static void the_code_of_every_collider_too(void **state)
{
    static const char *const RUNS[] = {
        FACETS "--schemes direct/plain/textbook/staves",
        FACETS "--schemes direct/staggered/midpoint/staves-gjk",
        FACETS "--schemes direct/staggered/corrected/ode-convex",
        FACETS "--schemes quick/staggered/midpoint/trimesh",
    };
    check_codes(state, RUNS, sizeof RUNS / sizeof *RUNS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_code_gives_the_same_run_bit_for_bit, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(the_code_of_limited_joints_too, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(the_code_of_ideal_joints_too, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(the_code_of_every_collider_too, program_set_up,
                                        program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Does `jointplay tune` find what it says, and hand on what was asked for?
#include "program.h"

// its contacts are all in the first degrees
#define K66_CASE                                                                                   \
    "$cases/paper/impact-k66.yaml --set run.start=centred --set contact.resting-speed=none --set " \
    "run.revolutions=0.1"
static const char K66[] = K66_CASE;
static const char IDEAL[] = "$cases/paper/ideal-nominal.yaml";

static double number(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

static const char *words(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    assert_non_null(text);
    return text;
}

static json_t *tune(Program *program, const char *options, int status)
{
    char line[3 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line, "tune %s --json --quiet", options);
    program_run(program, line);
    if (program->status != status) {
        fail_msg("%s: status %d: %s", line, program->status, program->errors);
    }
    return program_json(program);
}

// The run of ODE among those that the printed command line makes.
static json_t *run_again(Program *program, const json_t *setting, const char *more)
{
    static const char PROGRAM_NAME[] = "jointplay ";
    char line[2 * PROGRAM_PATH_SIZE];
    const char *command = words(setting, "command");
    assert_int_equal(strncmp(command, PROGRAM_NAME, sizeof PROGRAM_NAME - 1), 0);
    snprintf(line, sizeof line, "%s --json --quiet %s", command + sizeof PROGRAM_NAME - 1, more);
    program_run(program, line);
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    json_t *runs = json_object_get(root, "runs");
    json_t *run = json_incref(json_array_get(runs, json_array_size(runs) - 1));
    json_decref(root);
    assert_string_equal(words(run, "backend"), "ode");
    return run;
}

static void the_error_is_met_on_running_again(void **state)
{
    Program *program = *state;
    static const char *const CASES[] = {K66, IDEAL};
    for (int i = 0; i < 2; i++) {
        char options[PROGRAM_PATH_SIZE];
        snprintf(options, sizeof options, "%s --error 3e-3", CASES[i]);
        json_t *root = tune(program, options, 0);
        const json_t *cheapest = json_object_get(root, "cheapest");
        json_t *run = run_again(program, cheapest, "");
        assert_string_equal(words(run, "hash"), words(cheapest, "hash"));
        const json_t *error = json_object_get(run, "error");
        assert_true(number(error, "max") <= 3e-3);
        assert_close(number(error, "max"), number(cheapest, "error_max"), 1e-12);
        // and the plain rows as well, where there are contacts
        const json_t *loop = json_object_get(root, "own_loop");
        if (i == 0) {
            json_t *plain = run_again(program, loop, "");
            assert_true(number(json_object_get(plain, "error"), "omega_max") <= 3e-3);
            json_decref(plain);
        } else {
            assert_true(json_is_null(loop));
        }
        json_decref(run);
        json_decref(root);
    }
}

// The hash of a run of the reference at a tolerance.
static json_t *reference_run(Program *program, double tolerance)
{
    char line[2 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line,
             "run %s --json --quiet --uncertified --backend reference --set "
             "reference.tolerance=%.17g",
             K66, tolerance);
    program_run(program, line);
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    json_t *run = json_incref(json_array_get(json_object_get(root, "runs"), 0));
    json_decref(root);
    return run;
}

// The loosest tolerance that meets an error is looser than that of a smaller one, and its run can
// be made again.
static void the_reference_stands_beside_the_settings_of_ode(void **state)
{
    Program *program = *state;
    static const double ERRORS[] = {1e-2, 1e-7};
    double tolerances[2];
    for (int i = 0; i < 2; i++) {
        char options[PROGRAM_PATH_SIZE];
        snprintf(options, sizeof options, "%s --error %g --schemes direct/staggered/impulse", K66,
                 ERRORS[i]);
        json_t *root = tune(program, options, 0);
        const json_t *reference = json_object_get(root, "reference");
        tolerances[i] = number(reference, "tolerance");
        assert_true(number(reference, "error_max") > 0.0);
        assert_true(number(reference, "error_max") < ERRORS[i]);
        assert_true(number(reference, "processor_median_s") > 0.0);
        json_t *again = reference_run(program, tolerances[i]);
        assert_string_equal(words(again, "hash"), words(reference, "hash"));
        json_decref(again);
        // control: another tolerance is another run
        again = reference_run(program, 0.5 * tolerances[i]);
        assert_string_not_equal(words(again, "hash"), words(reference, "hash"));
        json_decref(again);
        json_decref(root);
    }
    assert_true(tolerances[1] < 0.1 * tolerances[0]);
    json_t *root =
        tune(program, K66_CASE " --at-step '20 us' --schemes direct/staggered/impulse", 0);
    assert_true(json_is_null(json_object_get(root, "reference")));
    json_decref(root);
    program_run(program,
                "tune --full " K66_CASE " -q --error 1e-2 --schemes direct/staggered/impulse");
    assert_says(program->output, "Without ODE");
    assert_says(program->output, "reference, tolerance ");
}

// The cheapest point of a comparison that meets an error, by world steps.
static double cheapest_steps(const json_t *root, double error)
{
    double least = INFINITY;
    const json_t *schemes = json_object_get(root, "schemes");
    for (size_t i = 0; i < json_array_size(schemes); i++) {
        const json_t *scheme = json_array_get(schemes, i);
        const json_t *points = json_object_get(scheme, "points");
        for (size_t k = 0; k < json_array_size(points); k++) {
            const json_t *point = json_array_get(points, k);
            const json_t *reached = json_object_get(point, "error_max");
            if (strcmp(words(scheme, "backend"), "ode") == 0 && json_is_number(reached) &&
                json_number_value(reached) <= error) {
                least = fmin(least, number(point, "steps"));
            }
        }
    }
    return least;
}

static void nothing_much_cheaper_is_found_by_running_everything(void **state)
{
    Program *program = *state;
    char line[2 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line, "%s --error 1e-2 --cost steps --schemes direct/staggered", K66);
    json_t *root = tune(program, line, 0);
    const double found = number(json_object_get(root, "cheapest"), "steps");
    json_decref(root);
    // twice as fine as the grid of the search
    snprintf(line, sizeof line,
             "compare %s --quiet --json --store s.jsonl --schemes direct/staggered/impulse,"
             "direct/staggered/midpoint --steps '500us, 450us, 400us, 355us, 315us, 280us, 250us, "
             "224us, 200us, 25us, 20us, 18us'",
             K66);
    program_run(program, line);
    assert_int_equal(program->status, 0);
    root = program_json(program);
    assert_true(found <= 1.5 * cheapest_steps(root, 1e-2));
    json_decref(root);
}

// Of a run with --json and --out: the tables, as they would be printed without them.
static void read_tables(Program *program)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "out/impact-k66-tune.txt", path);
    program_read(path, program->output);
}

static void a_cost_that_is_too_small_ends_with_status_1(void **state)
{
    Program *program = *state;
    char line[PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line, "%s --error 1e-3 --max-cost 40 --out out", K66);
    json_t *root = tune(program, line, 1);
    assert_true(json_is_false(json_object_get(root, "is_met")));
    const json_t *least = json_object_get(root, "least_error");
    assert_true(number(least, "steps") <= 40.0);
    assert_true(number(least, "error_max") > 1e-3);
    assert_true(number(json_object_get(root, "cheapest"), "steps") > 40.0);
    json_decref(root);
    assert_says(program->errors, "no setting within --max-cost meets an error of 0.001");
    read_tables(program);
    assert_says(program->output, "none within the cost");
}

// Of one scheme in a comparison at one step.
static double compared_error(Program *program, const char *scheme, const char *step)
{
    char line[2 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line,
             "compare %s --quiet --json --schemes %s --steps '%s' --store %s.jsonl", K66, scheme,
             step, strrchr(scheme, '/') + 1);
    program_run(program, line);
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *first = json_array_get(json_object_get(root, "schemes"), 0);
    const json_t *point = json_array_get(json_object_get(first, "points"), 0);
    const double error = number(point, "error_max");
    json_decref(root);
    return error;
}

// The best of the step that is held, against the same schemes compared at it.
static void at_a_step_that_is_held_the_least_error_is_named(void **state)
{
    Program *program = *state;
    char line[2 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line,
             "%s --at-step '80 us' --error 3e-3 --schemes "
             "direct/plain/textbook,direct/staggered/impulse",
             K66);
    json_t *root = tune(program, line, 0);
    assert_true(json_is_true(json_object_get(root, "is_met")));
    assert_near(number(root, "step_held_s"), 8e-5, 1e-18);
    const json_t *best = json_object_get(root, "best_at_step");
    assert_string_equal(words(best, "scheme"), "direct/staggered/impulse");
    assert_near(number(best, "step_s"), 8e-5, 1e-18);
    assert_close(number(best, "error_max"),
                 compared_error(program, "direct/staggered/impulse", "80 us"), 1e-9);
    json_t *run = run_again(program, best, "");
    assert_string_equal(words(run, "hash"), words(best, "hash"));
    json_decref(run);
    // control: the scheme that is not named is worse, and is that of a loop of one's own
    const json_t *loop = json_object_get(root, "own_loop");
    assert_string_equal(words(loop, "scheme"), "direct/plain/textbook");
    const double plain = compared_error(program, "direct/plain/textbook", "80 us");
    assert_close(number(loop, "error_max"), plain, 1e-9);
    assert_true(plain > 2.0 * number(best, "error_max"));
    assert_int_equal(json_array_size(json_object_get(root, "trials")), 2);
    assert_near(number(json_object_get(root, "gazebo"), "max_step_size"), 8e-5, 1e-18);
    // every constant is of that step, and the one handed on has the least error of all kp and kd
    const json_t *constants = json_object_get(root, "constants");
    const double taken = number(json_object_get(root, "gazebo"), "error_max");
    assert_true(json_array_size(constants) >= 5);
    for (size_t i = 0; i < json_array_size(constants); i++) {
        const json_t *one = json_array_get(constants, i);
        const json_t *error = json_object_get(one, "error_max");
        assert_near(number(one, "step_s"), 8e-5, 1e-18);
        assert_true(json_is_true(json_object_get(one, "is_row")) || json_is_null(error) ||
                    json_number_value(error) >= taken);
    }
    json_decref(root);
}

// The grid has ten preferred numbers a decade, of ISO 3: the one above that has this value.
static double next_of_grid(double value)
{
    static const double NUMBERS[] = {1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0, 10.0};
    const double decade = pow(10.0, floor(log10(value) + 1e-9));
    size_t i = 0;
    while (NUMBERS[i] * decade < value * (1.0 + 1e-9)) {
        i++;
    }
    return NUMBERS[i] * decade;
}

static void where_nothing_at_the_step_will_do_the_longest_that_does_is_named(void **state)
{
    Program *program = *state;
    static const char SCHEMES[] = "--schemes direct/plain/textbook,direct/staggered/impulse";
    char line[2 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line, "%s --at-step '800 us' --error 1e-2 --out out %s", K66, SCHEMES);
    json_t *root = tune(program, line, 1);
    assert_says(program->errors, "nothing at 800 us meets an error of 0.01; the least there is");
    assert_says(program->errors, "the longest step that meets 0.01: direct/staggered/impulse");
    read_tables(program);
    assert_says(program->output, "Contacts with constants at 800 us");
    const char *held = strstr(program->output, "Schemes at 800 us");
    assert_non_null(held);
    assert_true(strstr(held, "meets it") > strstr(held, "Schemes at shorter steps"));
    assert_true(json_is_false(json_object_get(root, "is_met")));
    assert_true(number(json_object_get(root, "best_at_step"), "error_max") > 1e-2);
    const json_t *longest = json_object_get(root, "longest_step");
    assert_true(number(longest, "error_max") <= 1e-2);
    assert_true(number(longest, "step_s") < 8e-4);
    // control: the next longer step of the grid does not meet it
    char step[64];
    snprintf(step, sizeof step, "%.4g s", next_of_grid(number(longest, "step_s")));
    assert_true(compared_error(program, "direct/staggered/impulse", step) > 1e-2);
    json_decref(root);
    // without an error to meet the best is an answer
    snprintf(line, sizeof line, "%s --at-step '800 us' --schemes direct", IDEAL);
    root = tune(program, line, 0);
    assert_true(json_is_null(json_object_get(root, "longest_step")));
    assert_true(json_is_null(json_object_get(root, "error_asked")));
    json_decref(root);
}

// A linear law is one spring whatever the depth: no constants are run twice.
static void a_linear_law_has_one_spring(void **state)
{
    Program *program = *state;
    json_t *root = tune(program,
                        "$cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --set run.revolutions=0.05 "
                        "--set 'contact.stiffness=1e8 N/m' "
                        "--error 1e-2 --schemes direct/staggered/impulse",
                        0);
    const json_t *constants = json_object_get(root, "constants");
    assert_true(json_array_size(constants) >= 1);
    for (size_t i = 0; i < json_array_size(constants); i++) {
        const json_t *one = json_array_get(constants, i);
        assert_close(number(one, "stiffness_N_m"), 1e8, 1e-12);
        for (size_t k = 0; k < i; k++) {
            assert_true(number(json_array_get(constants, k), "step_s") != number(one, "step_s"));
        }
    }
    json_decref(root);
}

// Where errors fall with the step, 1e-9 takes a million times the steps of 1e-3.
static void a_search_that_would_take_too_long_says_so(void **state)
{
    Program *program = *state;
    char line[2 * PROGRAM_PATH_SIZE];
    snprintf(
        line, sizeof line,
        "%s --set run.revolutions=0.1 --schemes direct/plain --error 1e-9 --time-limit '0.5 s'",
        IDEAL);
    json_t *root = tune(program, line, 1);
    const json_t *scheme = json_array_get(json_object_get(root, "schemes"), 0);
    assert_string_equal(words(scheme, "outcome"), "too-long");
    json_decref(root);
    // the control: an error that its first runs meet
    snprintf(line, sizeof line, "%s --set run.revolutions=0.1 --schemes direct/plain --error 1e-2",
             IDEAL);
    root = tune(program, line, 0);
    scheme = json_array_get(json_object_get(root, "schemes"), 0);
    assert_string_equal(words(scheme, "outcome"), "meets");
    json_decref(root);
}

// In the tables stand the same keys of a case as in JSON, whose run meets the error.
static void expect_keys_in_tables(Program *program)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "out/impact-k66-tune.json", path);
    json_t *root = json_load_file(path, 0, NULL);
    assert_non_null(root);
    read_tables(program);
    char *first = strstr(program->output, "\n  in a case ");
    assert_non_null(first);
    char *end = strstr(first, "\n  run it");
    assert_non_null(end);
    *end = '\0';
    json_t *keys = json_object_get(json_object_get(root, "cheapest"), "keys");
    assert_true(json_object_size(keys) >= 4);
    const char *key = NULL;
    json_t *value = NULL;
    json_object_foreach(keys, key, value)
    {
        char row[128];
        snprintf(row, sizeof row, " %s=%s", key, json_string_value(value));
        assert_says(first, row);
    }
    json_decref(root);
}

// By the compiler that the program was built with; test_tune_world.c runs such programs.
static void expect_code_compiles(Program *program)
{
    char line[2 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line,
             "cd '%s/out' && $JOINTPLAY_CC -fsyntax-only -Wall -Werror -I\"$JOINTPLAY_HEADERS\" "
             "impact-k66-tune.c",
             program->folder);
    assert_int_equal(system(line), 0);
}

static void files_hold_what_was_asked_for(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_run(program, "tune --full $cases/paper/impact-k66.yaml --set run.start=centred --set "
                         "contact.resting-speed=none --error 3e-2 --schemes "
                         "direct/plain/corrected --sdf c.sdf --mjcf c.xml --out out");
    // a file that misses the error is written where it is named, and is a failure
    assert_int_equal(program->status, 1);
    assert_says(program->errors, "the file of --sdf misses the error: it has an error of ");
    assert_says(program->errors, "times the 0.03 asked for");
    assert_says(program->output, "soft_cfm");
    program_path(program, "c.sdf", path);
    program_read(path, program->output);
    assert_says(program->output, "<max_step_size>");
    assert_says(program->output, "<kp>");
    program_path(program, "c.xml", path);
    program_read(path, program->output);
    assert_says(program->output, "<mujoco"); // whole, where there is a driver
    static const char *const ENDINGS[] = {".txt", ".json", ".c", ".sdf", ".xml"};
    for (int i = 0; i < 5; i++) {
        char name[64];
        snprintf(name, sizeof name, "out/impact-k66-tune%s", ENDINGS[i]);
        program_path(program, name, path);
        assert_int_equal(access(path, R_OK), 0);
    }
    expect_keys_in_tables(program);
    expect_code_compiles(program);
    // ideal joints have no contact to hand on
    program_fails_usage(program, "tune $cases/paper/ideal-nominal.yaml --error 1e-2 --sdf none.sdf",
                        "--sdf: no joint of the case has play");
    program_fails_usage(program,
                        "tune $cases/paper/ideal-nominal.yaml --error 1e-2 --mjcf none.xml",
                        "--mjcf: no joint of the case has play");
}

// Of what a folder gets by the way, what misses the error is left out, and said.
static void a_folder_gets_what_meets_the_error(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_run(program, "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                         "contact.resting-speed=none --error 3e-2 --schemes "
                         "direct/plain/corrected --out kept");
    assert_int_equal(program->status, 0);
    assert_says(program->errors, "not written: kept/impact-k66-tune.sdf (it has an error of ");
    assert_says(program->output, "--code: step ");
    assert_says(program->output, "--sdf: step ");
    program_path(program, "kept/impact-k66-tune.c", path);
    assert_int_equal(access(path, R_OK), 0);
    program_path(program, "kept/impact-k66-tune.sdf", path);
    assert_int_not_equal(access(path, R_OK), 0);
}

static void what_cannot_be_asked_is_refused(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "tune", "no case given");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none",
                        "no error given");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --error 0",
                        "--error is 0; allowed: a number above 0, up to 0.5");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --error 1e-3 --max-cost 50kg",
                        "--max-cost is 50kg; allowed: a time above 0");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --error 1e-3 --cost steps --max-cost 1s",
                        "--cost steps and a --max-cost in time do not go together");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --error 1e-3 --schemes plian",
                        "no scheme of this case is 'plian'");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --error 1e-14 --quiet",
                        "is below ten times the uncertainty of the reference");
    program_fails_usage(program, "tune a.yaml --error 1e-3 --code x --sdf x", "would both write x");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --at-step 1ms --cost steps",
                        "--cost and --at-step do not go together");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --at-step 1ms --max-cost 9",
                        "--max-cost and --at-step do not go together");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --at-step 1ms --schemes auto",
                        "--at-step needs one that takes the step it is given");
    program_fails_usage(program,
                        "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                        "contact.resting-speed=none --at-step '1 s'",
                        "is longer than the run");
    program_run(program, "tune $cases/paper/stackup-poisson.yaml --error 1e-3");
    assert_int_equal(program->status, 3);
    assert_says(program->errors, "contact.model poisson has no spring");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_reference_stands_beside_the_settings_of_ode,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(the_error_is_met_on_running_again, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(nothing_much_cheaper_is_found_by_running_everything,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(a_cost_that_is_too_small_ends_with_status_1, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(at_a_step_that_is_held_the_least_error_is_named,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(
            where_nothing_at_the_step_will_do_the_longest_that_does_is_named, program_set_up,
            program_tear_down),
        cmocka_unit_test_setup_teardown(a_linear_law_has_one_spring, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_search_that_would_take_too_long_says_so, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(files_hold_what_was_asked_for, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_folder_gets_what_meets_the_error, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(what_cannot_be_asked_is_refused, program_set_up,
                                        program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

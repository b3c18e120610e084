// Does `jointplay check` know how runs end, and does it never pass one that ends otherwise?
#include "close.h"
#include "program.h"

// A pin that falls in its hole and bounces: a few milliseconds of work.
static const char PIN[] =
    "title: A pin\n"
    "bodies:\n  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}\n"
    "joints:\n  hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 20.2 mm, pin: 20 mm}\n"
    "contact: {stiffness: 6.6e10 N/m^1.5, restitution: 0.9}\n"
    "run: {duration: 12 ms, samples: 100, step: 5 us, backends: [reference, ode]}\n";

// The same pin, so fast in a hole so soft that it leaves it.
static const char ESCAPE[] =
    "title: A pin that leaves its hole\n"
    "bodies:\n  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm], velocity: [10 m/s, 0 "
    "m/s]}\n"
    "joints:\n  hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 20.2 mm, pin: 20 mm}\n"
    "contact: {stiffness: 1e4 N/m^1.5, restitution: 0.9}\n"
    "run: {duration: 5 ms, samples: 100, step: 5 us, backends: [reference, ode]}\n";

// A pin that starts inside the wall.
static const char INSIDE[] =
    "title: A start in the wall\n"
    "bodies:\n  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}\n"
    "joints:\n  hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 20.2 mm, pin: 20 mm, start: "
    "[0.2 mm, 0 mm]}\n"
    "run: {duration: 5 ms}\n";

static void write_case(const Program *program, const char *name, const char *text,
                       const char *outcomes)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream, "%sexpect:\n%s", text, outcomes);
    fclose(stream);
}

static const json_t *outcome_of(const json_t *root, size_t number)
{
    const json_t *item = json_array_get(json_object_get(root, "cases"), 0);
    return json_array_get(json_object_get(item, "outcomes"), number);
}

static void a_run_agrees_within_its_limit_alone(void **state)
{
    Program *program = *state;
    write_case(program, "pin.yaml", PIN,
               "  reference.outcome: agrees within 1e-8\n"
               "  direct/staggered/impulse.outcome: agrees within 1e-4\n"
               "  auto/1e-3.outcome: agrees within 1e-3\n");
    program_run(program, "check -q --expect-only pin.yaml --json");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *first = outcome_of(root, 0);
    const json_t *second = outcome_of(root, 1);
    assert_string_equal(json_string_value(json_object_get(first, "run")), "reference");
    assert_string_equal(json_string_value(json_object_get(second, "outcome")), "agrees");
    const double error = json_number_value(json_object_get(second, "error"));
    assert_true(error > json_number_value(json_object_get(second, "reference_uncertainty")));
    // the errors are taken over the whole run
    assert_near(json_number_value(json_object_get(second, "horizon_s")), 0.012, 1e-9);
    json_decref(root);
    // the control: a limit below the error that was found
    char outcomes[256];
    snprintf(outcomes, sizeof outcomes,
             "  direct/staggered/impulse.outcome: agrees within %.3g\n"
             "  auto/1e-3.outcome: agrees within 1e-3\n",
             0.5 * error);
    write_case(program, "pin.yaml", PIN, outcomes);
    program_run(program, "check -q --expect-only pin.yaml");
    assert_int_equal(program->status, 1);
    assert_says(program->output, "WRONG");
    assert_says(program->output,
                "2 outcomes: 1 agrees, 0 reported, 0 detected, 0 refused, 1 WRONG");
    assert_says(program->errors, "pin.yaml: direct/staggered/impulse: error ");
    assert_says(program->errors, "expected: agrees within ");
}

static void a_large_error_is_reported_and_a_small_one_is_not(void **state)
{
    Program *program = *state;
    write_case(program, "pin.yaml", PIN, "  direct/plain/textbook.outcome: reported above 0.1\n");
    program_run(program, "check -q --expect-only pin.yaml");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "1 outcome: 0 agrees, 1 reported");
    write_case(program, "pin.yaml", PIN,
               "  direct/staggered/impulse.outcome: reported above 0.1\n");
    program_run(program, "check -q --expect-only pin.yaml");
    assert_int_equal(program->status, 1);
}

static void a_run_that_stops_must_say_why(void **state)
{
    Program *program = *state;
    write_case(program, "escape.yaml", ESCAPE,
               "  outcome: detected as \"inside the wall of its hole\"\n"
               "  auto/1e-4.outcome: refused with \"no step can be chosen\"\n");
    program_run(program, "check -q --expect-only escape.yaml");
    assert_int_equal(program->status, 0);
    assert_says(program->output,
                "3 outcomes: 0 agrees, 0 reported, 2 detected, 1 refused, 0 WRONG");
    // the controls: other words, and a run that stops where it should agree or be refused
    static const char *const WRONG[] = {"detected as \"a change point\"", "agrees within 0.1",
                                        "refused with \"inside the wall of its hole\"",
                                        "reported above 0.1"};
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        char outcomes[128];
        snprintf(outcomes, sizeof outcomes, "  ode.outcome: %s\n", WRONG[i]);
        write_case(program, "escape.yaml", ESCAPE, outcomes);
        program_run(program, "check -q --expect-only escape.yaml");
        assert_int_equal(program->status, 1);
        assert_says(program->errors, "escape.yaml: ode: detected: at ");
    }
}

static void a_case_file_that_is_refused_must_expect_it(void **state)
{
    Program *program = *state;
    write_case(program, "inside.yaml", INSIDE, "  outcome: refused with \"inside the metal\"\n");
    program_run(program, "check -q --expect-only inside.yaml");
    assert_int_equal(program->status, 0);
    // the controls: refused for another reason, and not expected to be
    write_case(program, "inside.yaml", INSIDE, "  outcome: refused with \"does not close\"\n");
    program_run(program, "check -q --expect-only inside.yaml");
    assert_int_equal(program->status, 1);
    write_case(program, "inside.yaml", INSIDE, "  outcome: agrees within 0.1\n");
    program_run(program, "check -q --expect-only inside.yaml");
    assert_int_equal(program->status, 3);
    // and a case that is not refused though it expects to be
    write_case(program, "pin.yaml", PIN, "  outcome: refused with \"inside the metal\"\n");
    program_run(program, "check -q --expect-only pin.yaml");
    assert_int_equal(program->status, 1);
    assert_says(program->output, "2 WRONG");
}

static void a_folder_is_all_cases_in_it(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    write_case(program, "b.yaml", INSIDE, "  outcome: refused with \"inside the metal\"\n");
    write_case(program, "a.yaml", ESCAPE,
               "  ode.outcome: detected as \"inside the wall\"\n"
               "  reference.outcome: detected as \"inside the wall\"\n");
    program_run(program, "check -q . --markdown table.md --junit tests.xml");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "2 cases: 2 within, 0 out");
    char *text = malloc(PROGRAM_OUTPUT_SIZE);
    program_path(program, "table.md", path);
    program_read(path, text);
    assert_says(text, "| a.yaml | A pin that leaves its hole | ode | detected: at ");
    assert_says(text, "| b.yaml | A start in the wall | case | refused: ");
    program_path(program, "tests.xml", path);
    program_read(path, text);
    assert_says(text, "name=\"expect/ode/outcome\"");
    assert_says(text, "name=\"expect/reference/outcome\"");
    free(text);
    program_run(program, "check -q nothing");
    assert_int_equal(program->status, 5);
    program_run(program, "check -q --set run.step=auto a.yaml b.yaml");
    assert_int_equal(program->status, 1);
}

static void an_outcome_names_a_scheme_that_the_case_has(void **state)
{
    Program *program = *state;
    write_case(program, "pin.yaml", PIN, "  extrapolated.outcome: agrees within 0.1\n");
    program_run(program, "check -q --expect-only pin.yaml");
    assert_int_equal(program->status, 3);
    assert_says(program->errors, "no scheme of this case is 'extrapolated'");
    write_case(program, "pin.yaml", PIN, "  direct/staggered/impulse.outcome: agrees within 0.1\n");
    program_run(program, "check -q --expect-only --set run.step=auto pin.yaml");
    assert_int_equal(program->status, 3);
    assert_says(program->errors, "needs a step, and run.step is auto");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_run_agrees_within_its_limit_alone, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_large_error_is_reported_and_a_small_one_is_not,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(a_run_that_stops_must_say_why, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_case_file_that_is_refused_must_expect_it, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_folder_is_all_cases_in_it, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(an_outcome_names_a_scheme_that_the_case_has, program_set_up,
                                        program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

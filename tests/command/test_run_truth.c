// Does `jointplay run` hold its runs against a certified reference, and say where that ends?
#include "program.h"

static const json_t *run_at(const json_t *root, size_t index)
{
    return json_array_get(json_object_get(root, "runs"), index);
}

static double number_of(const json_t *object, const char *group, const char *key)
{
    const json_t *value = json_object_get(json_object_get(object, group), key);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

static void errors_are_against_the_certified_reference(void **state)
{
    Program *program = *state;
    program_run(program, "run --json $cases/paper/impact-k66.yaml --set run.start=centred "
                         "--set contact.resting-speed=none");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *truth = json_object_get(root, "truth");
    assert_string_equal(json_string_value(json_object_get(truth, "backend")), "reference");
    assert_string_equal(json_string_value(json_object_get(run_at(root, 1), "backend")),
                        "reference");
    // the reference is not held against itself
    assert_true(json_is_null(json_object_get(run_at(root, 1), "error")));
    const json_t *ode = run_at(root, 2);
    assert_true(number_of(ode, "error", "reference_uncertainty") < 1e-6);
    assert_true(number_of(ode, "error", "omega_max_in_horizon") < 0.05);
    assert_true(number_of(ode, "error", "omega_max_in_horizon") > 1e-6);
    // steps that are longer than impacts turn the pin's velocity round late
    assert_true(number_of(ode, "error", "max_in_horizon") > 0.1);
    assert_true(number_of(ode, "error", "max_in_horizon") < 2.0);
    assert_false(json_is_true(json_object_get(json_object_get(ode, "error"), "includes_play")));
    const json_t *ideal = json_object_get(run_at(root, 0), "error");
    assert_true(json_is_true(json_object_get(ideal, "includes_play")));
    // both see the first contact, within ODE's step
    const json_t *match = json_object_get(json_object_get(ode, "spike_match"), "crank-coupler");
    const json_t *pair = json_array_get(json_object_get(match, "pairs"), 0);
    assert_near(json_number_value(json_object_get(pair, "onset_delay_s")), 0.0, 2e-6);
    // what the drive does is stored or dissipated
    const json_t *reference = run_at(root, 1);
    assert_near(number_of(reference, "energy", "residual_J"), 0.0,
                1e-6 * fabs(number_of(reference, "energy", "drive_work_J")));
    json_decref(root);
}

static void beyond_the_horizon_distributions_stand_in_for_errors(void **state)
{
    Program *program = *state;
    program_run(program, "run --full $cases/literature/four-bar-half-mm.yaml --set run.step=10us "
                         "--set run.revolutions=0.5");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "The motion cannot be predicted beyond ");
    assert_says(program->output, "Over starts that differ by 0.001 of the speeds");
    assert_says(program->output, "reference: 16 starts");
    assert_says(program->output, "ode: 16 starts");
}

static void ideal_joints_have_the_closed_form_for_truth(void **state)
{
    Program *program = *state;
    program_run(program, "run $cases/paper/ideal-nominal.yaml --json --backend "
                         "analytic,reference,ode");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *truth = json_object_get(root, "truth");
    assert_string_equal(json_string_value(json_object_get(truth, "backend")), "analytic");
    assert_string_equal(json_string_value(json_object_get(run_at(root, 1), "backend")),
                        "reference");
    assert_true(number_of(run_at(root, 1), "error", "max") < 1e-8);
    assert_true(json_is_null(json_object_get(run_at(root, 2), "spike_match")));
    json_decref(root);
}

static void a_reference_that_is_not_certified_says_so(void **state)
{
    Program *program = *state;
    program_run(program, "run --uncertified --json --backend reference,ode --step 20us "
                         "$cases/paper/impact-k66.yaml");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *truth = json_object_get(root, "truth");
    assert_string_equal(json_string_value(json_object_get(truth, "message")),
                        "is not certified: --uncertified");
    static const char *const UNKNOWN[] = {"uncertainty", "horizon_s", "growth"};
    for (size_t i = 0; i < 3; i++) {
        assert_true(json_is_null(json_object_get(truth, UNKNOWN[i])));
    }
    // the errors are there, but nobody knows how sure they are
    const json_t *ode = run_at(root, 1);
    assert_true(number_of(ode, "error", "max") > 1e-6);
    const json_t *error = json_object_get(ode, "error");
    assert_true(json_is_null(json_object_get(error, "reference_uncertainty")));
    assert_true(json_is_null(json_object_get(error, "horizon_s")));
    json_decref(root);
    program_run(program,
                "run --full --uncertified --backend reference $cases/paper/impact-k66.yaml");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "The reference is not certified (--uncertified)");
    // a step that is chosen needs to know how sure the reference is
    program_run(program, "run --full --uncertified $cases/literature/three-clearances.yaml");
    assert_int_equal(program->status, 2);
    assert_says(program->errors, "with --uncertified give --step TIME");
}

static void a_pin_in_a_hole_runs_without_a_drive(void **state)
{
    Program *program = *state;
    program_run(program, "run --full $cases/literature/pin-in-hole-drop.yaml");
    assert_int_equal(program->status, 0);
    // it falls 0.1 mm: sqrt(2 c / g) = 4.516 ms
    assert_says(program->output, "4.5160");
    assert_says(program->output, "Contacts matched within the horizon, ode");
}

// A wrong number with nothing beside it that says so would be silent.
static void an_error_that_is_not_known_is_said_to_be(void **state)
{
    Program *program = *state;
    const char *words = "The error of ode is not known";
    program_run(
        program,
        "run --full -q --backend ode --step '5 us' $cases/literature/pin-in-hole-drop.yaml");
    assert_int_equal(program->status, 0);
    assert_says(program->output, words);
    // the controls: with the reference, and with a step chosen for an error, it is known
    program_run(program, "run --full -q --backend reference --backend ode --step '5 us' "
                         "$cases/literature/pin-in-hole-drop.yaml");
    assert_int_equal(program->status, 0);
    assert_true(strstr(program->output, words) == NULL);
    program_run(program, "run --full -q --backend ode $cases/literature/pin-in-hole-drop.yaml");
    assert_int_equal(program->status, 0);
    assert_true(strstr(program->output, words) == NULL);
}

#define COMMAND_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        COMMAND_TEST(an_error_that_is_not_known_is_said_to_be),
        COMMAND_TEST(errors_are_against_the_certified_reference),
        COMMAND_TEST(beyond_the_horizon_distributions_stand_in_for_errors),
        COMMAND_TEST(ideal_joints_have_the_closed_form_for_truth),
        COMMAND_TEST(a_reference_that_is_not_certified_says_so),
        COMMAND_TEST(a_pin_in_a_hole_runs_without_a_drive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

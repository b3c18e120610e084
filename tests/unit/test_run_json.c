// Does JSON hold what the trajectory holds, under the keys that others rely on?
#include "commands/run/run_report.h"

#include "truth_fixture.h"

static double number_at(const json_t *object, const char *first, const char *second,
                        const char *third)
{
    const json_t *value = json_object_get(object, first);
    value = second == NULL ? value : json_object_get(value, second);
    value = third == NULL ? value : json_object_get(value, third);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

static void json_holds_the_keys_that_others_rely_on(void **state)
{
    Fixture *fixture = *state;
    json_t *root = run_json_build(&fixture->report);
    assert_string_equal(json_string_value(json_object_get(root, "case")), "cases/test.yaml");
    const json_t *tool = json_object_get(root, "tool");
    static const char *const VERSIONS[] = {"version", "ode", "ccd"};
    for (int i = 0; i < 3; i++) {
        assert_true(json_is_string(json_object_get(tool, VERSIONS[i])));
    }
    const json_t *run = json_array_get(json_object_get(root, "runs"), 1);
    assert_string_equal(json_string_value(json_object_get(run, "backend")), "ode");
    assert_string_equal(json_string_value(json_object_get(run, "status")), "ok");
    assert_string_equal(json_string_value(json_object_get(run, "message")), "");
    assert_string_equal(json_string_value(json_object_get(run, "hash")), "0123456789abcdef");
    assert_true(number_at(run, "step_s", NULL, NULL) == 1e-6);
    assert_true(number_at(run, "steps", NULL, NULL) == 2000.0);
    assert_true(number_at(run, "wall_s", NULL, NULL) == 0.004);
    assert_close(number_at(run, "us_per_step", NULL, NULL), 2.0, 1e-12);
    assert_close(number_at(run, "real_time_factor", NULL, NULL),
                 scenario_duration(&fixture->scenario) / 0.004, 1e-12);
    assert_true(number_at(run, "bodies", "coupler", "omega_max_rad_s") == 42.2008);
    assert_true(number_at(run, "bodies", "coupler", "omega_min_rad_s") == 0.0);
    assert_true(number_at(run, "bodies", "coupler", "alpha_max_rad_s2") == 0.0);
    assert_true(number_at(run, "bodies", "coupler", "alpha_min_rad_s2") == -11970.4);
    assert_null(json_object_get(json_object_get(run, "bodies"), "crank"));
    assert_true(number_at(run, "joints", "crank-coupler", "impacts") == 17.0);
    assert_true(number_at(run, "joints", "crank-coupler", "force_max_N") == 1234.5);
    assert_true(number_at(run, "joints", "crank-coupler", "impulse_N_s") == 0.75);
    assert_true(number_at(run, "joints", "crank-coupler", "penetration_max_m") == 2.5e-6);
    assert_close(number_at(run, "joints", "crank-coupler", "contact_fraction"), 0.25, 1e-12);
    assert_true(number_at(run, "error", "max", NULL) == 0.017);
    assert_true(number_at(run, "error", "omega_rms", NULL) == 0.004);
    const json_t *error = json_object_get(run, "error");
    assert_string_equal(json_string_value(json_object_get(error, "against")), "analytic");
    assert_true(json_is_null(json_object_get(error, "horizon_s")));
    assert_true(json_is_null(json_object_get(error, "reference_uncertainty")));
    assert_true(json_is_true(json_object_get(error, "includes_play")));
    assert_true(json_is_false(json_object_get(error, "limited_by_reference")));
    assert_true(json_is_null(json_object_get(root, "truth")));
    assert_true(json_is_null(json_object_get(run, "spike_match")));
    assert_true(json_is_null(json_object_get(run, "ensemble")));
    json_decref(root);
}

static void json_holds_the_truth_and_what_limits_it(void **state)
{
    TruthFixture *own = *state;
    json_t *root = run_json_build(&own->fixture->report);
    const json_t *truth = json_object_get(root, "truth");
    assert_string_equal(json_string_value(json_object_get(truth, "backend")), "reference");
    assert_true(number_at(truth, "growth", NULL, NULL) == 3.5e7);
    assert_true(json_is_true(json_object_get(truth, "is_limited")));
    assert_true(json_is_false(json_object_get(truth, "other_contact_model")));
    const json_t *run = json_array_get(json_object_get(root, "runs"), 1);
    assert_true(number_at(run, "error", "max_in_horizon", NULL) == 3e-9);
    assert_true(number_at(run, "error", "horizon_s", NULL) == 0.02);
    assert_true(number_at(run, "error", "reference_uncertainty", NULL) == 4e-10);
    const json_t *error = json_object_get(run, "error");
    assert_true(json_is_true(json_object_get(error, "limited_by_reference")));
    assert_true(json_is_false(json_object_get(error, "includes_play")));
    assert_true(number_at(run, "energy", "drive_work_J", NULL) == 2.0);
    assert_true(number_at(run, "energy", "dissipated_J", NULL) == 0.5);
    assert_true(number_at(run, "energy", "friction_J", NULL) == 0.125);
    assert_true(number_at(run, "energy", "change_J", NULL) == 1.25);
    assert_true(number_at(run, "energy", "residual_J", NULL) == 0.0625);
    const json_t *match = json_object_get(json_object_get(run, "spike_match"), "crank-coupler");
    assert_true(number_at(match, "missed", NULL, NULL) == 4.0);
    assert_true(number_at(match, "extra", NULL, NULL) == 5.0);
    const json_t *pair = json_array_get(json_object_get(match, "pairs"), 0);
    assert_true(number_at(pair, "reference_onset_s", NULL, NULL) == 0.030);
    assert_true(number_at(pair, "force_error", NULL, NULL) == -0.125);
    const json_t *ensemble = json_object_get(run, "ensemble");
    assert_true(number_at(ensemble, "members", NULL, NULL) == 14.0);
    const json_t *joint = json_object_get(json_object_get(ensemble, "joints"), "crank-coupler");
    assert_true(number_at(joint, "impulse_N_s", "deviation", NULL) == 0.03125);
    assert_true(number_at(joint, "contact_fraction", "median", NULL) == 0.5);
    json_decref(root);
    // one that could not be certified says why and ends nowhere; it has only the elastic law
    strcpy(own->truth.message, "the twin failed");
    own->fixture->scenario.contact.model = CONTACT_POISSON;
    root = run_json_build(&own->fixture->report);
    truth = json_object_get(root, "truth");
    assert_string_equal(json_string_value(json_object_get(truth, "message")),
                        "could not be certified: the twin failed");
    assert_true(json_is_null(json_object_get(truth, "horizon_s")));
    assert_true(json_is_true(json_object_get(truth, "other_contact_model")));
    json_decref(root);
    // a reference that failed says why and has no numbers
    own->fixture->runs[0]->is_complete = false;
    strcpy(own->fixture->runs[0]->message, "too stiff");
    root = run_json_build(&own->fixture->report);
    truth = json_object_get(root, "truth");
    assert_string_equal(json_string_value(json_object_get(truth, "message")), "too stiff");
    assert_null(json_object_get(truth, "uncertainty"));
    json_decref(root);
}

static void contacts_are_null_where_no_play_is_felt(void **state)
{
    Fixture *fixture = *state;
    static const char *const KEYS[] = {"impacts", "impulse_N_s", "penetration_max_m",
                                       "contact_fraction"};
    // the closed form takes the joint with play as ideal; ode's second joint has none
    static const char *const JOINTS[] = {"crank-coupler", "coupler-follower"};
    fixture->runs[0]->joints[1].impacts = 1;
    fixture->runs[0]->joints[1].impulse = 0.5;
    json_t *root = run_json_build(&fixture->report);
    for (size_t i = 0; i < 2; i++) {
        const json_t *run = json_array_get(json_object_get(root, "runs"), i);
        const json_t *joint = json_object_get(json_object_get(run, "joints"), JOINTS[i]);
        for (size_t k = 0; k < sizeof KEYS / sizeof KEYS[0]; k++) {
            assert_true(json_is_null(json_object_get(joint, KEYS[k])));
        }
        assert_true(json_is_number(json_object_get(joint, "force_max_N")));
        assert_int_equal(json_array_size(json_object_get(joint, "spikes")), 0);
    }
    json_decref(root);
}

static void json_angles_are_not_folded_into_one_turn(void **state)
{
    Fixture *fixture = *state;
    json_t *root = run_json_build(&fixture->report);
    const json_t *run = json_array_get(json_object_get(root, "runs"), 1);
    assert_close(number_at(run, "bodies", "coupler", "omega_max_crank_deg"), 6.7 * UNITS_DEG,
                 1e-12);
    assert_close(number_at(run, "bodies", "coupler", "alpha_min_crank_deg"), -0.1 * UNITS_DEG,
                 1e-12);
    json_decref(root);
}

static void json_of_the_closed_form_is_there_when_it_has_spoken(void **state)
{
    Fixture *fixture = *state;
    json_t *root = run_json_build(&fixture->report);
    assert_close(number_at(root, "kinematics", "transmission_angle_min_rad", NULL),
                 30.74 / UNITS_DEG, 1e-12);
    const json_t *forces = json_object_get(root, "inverse_dynamics");
    assert_true(number_at(forces, "drive_torque", "max_N_m", NULL) == 55.5);
    assert_true(number_at(forces, "reactions", "crank-coupler", "max_N") == 1504.7);
    const json_t *row = json_array_get(json_object_get(root, "stackup"), 0);
    assert_true(number_at(row, "max", "worst", NULL) == 5.0);
    assert_true(number_at(row, "max", "alone", "coupler length") == 0.5);
    const json_t *corner = json_object_get(json_object_get(row, "min"), "corner");
    assert_string_equal(json_string_value(json_object_get(corner, "coupler length")), "largest");
    assert_string_equal(json_string_value(json_object_get(corner, "play crank-coupler")),
                        "shortens coupler");
    json_decref(root);
    fixture->report.summary = NULL;
    fixture->report.stackup = NULL;
    root = run_json_build(&fixture->report);
    assert_null(json_object_get(root, "kinematics"));
    assert_null(json_object_get(root, "stackup"));
    json_decref(root);
    // asked for and not to be had: why
    fixture->report.no_summary = "it sticks";
    fixture->report.no_stackup = "it sticks within its tolerances";
    root = run_json_build(&fixture->report);
    static const char *const KEYS[] = {"kinematics", "inverse_dynamics", "stackup"};
    for (int i = 0; i < 3; i++) {
        const json_t *message = json_object_get(json_object_get(root, KEYS[i]), "message");
        assert_string_equal(json_string_value(message),
                            i < 2 ? "it sticks" : "it sticks within its tolerances");
    }
    json_decref(root);
}

static void a_failed_run_has_a_message_and_no_numbers(void **state)
{
    Fixture *fixture = *state;
    json_t *root = run_json_build(&fixture->report);
    json_t *run = json_array_get(json_object_get(root, "runs"), 2);
    assert_string_equal(json_string_value(json_object_get(run, "status")), "failed");
    assert_string_equal(json_string_value(json_object_get(run, "message")),
                        "not finite at 1.25 ms");
    const char *key;
    json_t *value;
    json_object_foreach(run, key, value)
    {
        assert_true(json_is_string(value));
    }
    json_decref(root);
}

static void a_number_that_is_not_finite_becomes_null(void **state)
{
    Fixture *fixture = *state;
    fixture->runs[1]->bodies[1].omega_max.value = NAN;
    json_t *root = run_json_build(&fixture->report);
    const json_t *run = json_array_get(json_object_get(root, "runs"), 1);
    const json_t *coupler = json_object_get(json_object_get(run, "bodies"), "coupler");
    assert_true(json_is_null(json_object_get(coupler, "omega_max_rad_s")));
    json_decref(root);
}

static void a_path_that_is_not_utf8_is_still_written(void **state)
{
    Fixture *fixture = *state;
    kept_set_path(&fixture->scenario, "cases/\xff.yaml");
    json_t *root = run_json_build(&fixture->report);
    assert_string_equal(json_string_value(json_object_get(root, "case")), "cases/\\xff.yaml");
    json_decref(root);
}

static void spikes_stand_below_their_body_or_joint(void **state)
{
    Fixture *fixture = *state;
    add_spikes(fixture);
    fixture->scenario.has_fourbar = true;
    fixture->scenario.fourbar.ground.nominal = 0.254;
    fixture->scenario.fourbar.crank.nominal = 0.108;
    fixture->scenario.fourbar.coupler.nominal = 0.2794;
    fixture->scenario.fourbar.follower.nominal = 0.2705;
    json_t *root = run_json_build(&fixture->report);
    const json_t *run = json_array_get(json_object_get(root, "runs"), 1);
    const json_t *body = json_object_get(json_object_get(run, "bodies"), "coupler");
    assert_true(number_at(body, "alpha_spike_count", NULL, NULL) == 40.0);
    assert_true(number_at(body, "alpha_spike_threshold_rad_s2", NULL, NULL) == 2e4);
    assert_true(number_at(body, "alpha_spike_resolution_rad_s2", NULL, NULL) == 400.0);
    const json_t *spike = json_array_get(json_object_get(body, "alpha_spikes"), 0);
    assert_true(number_at(spike, "onset_s", NULL, NULL) == 0.01);
    assert_true(number_at(spike, "peak_s", NULL, NULL) == 0.011);
    assert_true(number_at(spike, "end_s", NULL, NULL) == 0.012);
    assert_close(number_at(spike, "crank_deg", NULL, NULL), 3.0 * UNITS_DEG, 1e-12);
    assert_true(number_at(spike, "value_rad_s2", NULL, NULL) == -91000.0);
    assert_true(number_at(spike, "prominence_rad_s2", NULL, NULL) == 90000.0);
    assert_true(number_at(spike, "width_s", NULL, NULL) == 4e-5);
    assert_true(number_at(spike, "impulse_rad_s", NULL, NULL) == -3.5);
    assert_string_equal(json_string_value(json_object_get(spike, "joint")), "crank-coupler");
    const json_t *joint = json_object_get(json_object_get(run, "joints"), "crank-coupler");
    assert_true(number_at(joint, "force_spike_count", NULL, NULL) == 0.0);
    assert_int_equal(json_array_size(json_object_get(joint, "force_spikes")), 0);
    const json_t *bands = json_object_get(run, "spike_bands");
    const json_t *second = json_array_get(json_object_get(bands, "bands_deg"), 1);
    assert_true(json_number_value(json_array_get(second, 0)) == 290.0);
    assert_true(json_number_value(json_array_get(second, 1)) == 300.0);
    assert_true(number_at(bands, "bodies", "coupler", "inside") == 4.0);
    assert_true(number_at(bands, "bodies", "coupler", "outside") == 36.0);
    assert_true(number_at(bands, "bodies", "coupler", "largest_inside_rad_s2") == 60000.0);
    assert_true(number_at(bands, "bodies", "coupler", "largest_outside_rad_s2") == 91000.0);
    assert_true(number_at(bands, "joints", "crank-coupler", "inside") == 0.0);
    // the follower was not looked at: null, not 0
    body = json_object_get(json_object_get(run, "bodies"), "follower");
    assert_true(json_is_null(json_object_get(body, "alpha_spikes")));
    assert_true(json_is_null(json_object_get(body, "alpha_spike_count")));
    json_decref(root);
    // the paper's bands are those of its four-bar
    fixture->scenario.has_fourbar = false;
    root = run_json_build(&fixture->report);
    run = json_array_get(json_object_get(root, "runs"), 1);
    assert_true(json_is_null(json_object_get(run, "spike_bands")));
    json_decref(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(json_holds_the_keys_that_others_rely_on, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(contacts_are_null_where_no_play_is_felt, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(json_angles_are_not_folded_into_one_turn, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(json_of_the_closed_form_is_there_when_it_has_spoken,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_failed_run_has_a_message_and_no_numbers, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_number_that_is_not_finite_becomes_null, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_path_that_is_not_utf8_is_still_written, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(spikes_stand_below_their_body_or_joint, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(json_holds_the_truth_and_what_limits_it,
                                        truth_fixture_set_up, truth_fixture_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

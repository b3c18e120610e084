// Does the text say what was modelled and what came out?
#include "commands/run/run_report.h"

#include "truth_fixture.h"

#include "base/room.h"

#include <string.h>

static void expect_words(const char *text, const char *const *words)
{
    for (; *words != NULL; words++) {
        if (strstr(text, *words) == NULL) {
            print_error("'%s' is not in:\n%s\n", *words, text);
            fail();
        }
    }
}

static void the_text_says_what_was_modelled_and_what_came_out(void **state)
{
    Fixture *fixture = *state;
    static const char *const WORDS[] = {
        "A test & <nothing> else",
        "3 bodies, 4 joints, mobility",
        "hole 10.015 mm, pin 9.986 mm, radial clearance 14.5 um",
        "954.93 rpm counter-clockwise",
        "elastic, in an eye of 2 times its hole (assumed)",
        "damping lankarani-nikravesh, restitution 0.9",
        "step 1 us, 8 constraint rows, at most 1 contact row\n",
        "42.2008     383.9",
        "-11970.4      -5.7",
        "1234     171.9",
        "14.5 um",
        "The analytic solver takes every joint as ideal",
        "0.017",
        "broken failed: not finite at 1.25 ms",
        "transmission angle   30.74 deg",
        "power balance",
        "play crank-coupler shortens coupler",
        NULL,
    };
    Text text;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, WORDS);
    assert_null(strchr(text.data, '\x1b'));
    assert_null(strstr(text.data, "nan"));
    text_finish(&text);
}

static void a_chosen_step_says_why_its_error_is_not_known_further(void **state)
{
    Fixture *fixture = *state;
    Trajectory *run = fixture->runs[1];
    const double end_s = run->times[run->sample_count - 1];
    run->trials = 3;
    run->error_estimate = 5e-5;
    run->duration_s = 1.0001 * end_s; // whole steps go beyond the last sample
    static const char UNCERTAIN[] = "the reference is too uncertain";
    static const char UNPREDICTABLE[] = "the motion cannot be predicted further";
    for (int i = 0; i < 3; i++) {
        // the last sample may lie a rounding after the end
        run->estimate_s = i == 0 ? (1.0 - 1e-15) * end_s : 0.5 * end_s;
        run->estimate_is_cut = i == 1;
        Text text;
        text_init(&text);
        run_text_write(&fixture->report, &STYLE_PLAIN, &text);
        assert_non_null(strstr(text.data, "Its error is at most 5e-05"));
        assert_int_equal(strstr(text.data, UNCERTAIN) != NULL, i == 1);
        assert_int_equal(strstr(text.data, UNPREDICTABLE) != NULL, i == 2);
        text_finish(&text);
    }
}

static void springs_torques_and_friction_are_named(void **state)
{
    Fixture *fixture = *state;
    Linkage *linkage = &fixture->scenario.linkage;
    static Spring springs[] = {
        {.name = "return", .stiffness = 2e4, .length = 0.08, .damping = 20.0},
        {.name = "damper", .damping = 5.0},
        {.name = "idle"}};
    static TorsionSpring torsions[] = {{.name = "brake", .joint = 1, .damping = 0.05}};
    static const char *const WORDS[] = {
        "springs     return: 2e+04 N/m, relaxed at 80 mm, damping 20 N s/m\n",
        "damper: damping 5 N s/m\n",
        "idle: neither stiffness nor damping\n",
        "brake: damping 0.05 N m s/rad at crank-coupler\n",
        "drive       torque -0.3 to 0.5 N m by 2 points over time at ground-crank\n",
        "friction    coefficient 0.08\n",
        NULL,
    };
    Text text;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    assert_null(strstr(text.data, "  springs "));
    assert_null(strstr(text.data, "torque -0.3"));
    assert_null(strstr(text.data, "friction    coefficient"));
    text_finish(&text);
    const Linkage kept = *linkage;
    fixture->scenario.contact.friction = 0.08;
    linkage->springs = springs;
    linkage->spring_count = 3;
    linkage->torsions = torsions;
    linkage->torsion_count = 1;
    linkage->driver.is_present = false;
    linkage->torque = (Torque){.table = {.count = 2, .times = {0.0, 1.0}, .values = {0.5, -0.3}}};
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, WORDS);
    text_finish(&text);
    *linkage = kept;
}

static void what_is_rounding_is_shown_as_nothing_and_kept_in_json(void **state)
{
    Fixture *fixture = *state;
    Trajectory *run = fixture->runs[1];
    run->bodies[1].omega_max.value = 100.0;
    // the control: what is small and no rounding
    static const double SMALL[] = {1e-12, 1.23e-29};
    for (int is_rounding = 0; is_rounding < 2; is_rounding++) {
        run->bodies[2].omega_min.value = -SMALL[is_rounding];
        Text text;
        text_init(&text);
        run_text_write(&fixture->report, &STYLE_PLAIN, &text);
        assert_int_equal(strstr(text.data, "-1e-12") != NULL, is_rounding == 0);
        assert_null(strstr(text.data, "1.23e-29"));
        text_finish(&text);
        json_t *root = run_json_build(&fixture->report);
        const json_t *object = json_array_get(json_object_get(root, "runs"), 1);
        object = json_object_get(json_object_get(object, "bodies"), "follower");
        assert_near(json_real_value(json_object_get(object, "omega_min_rad_s")),
                    -SMALL[is_rounding], 0.0);
        json_decref(root);
    }
}

static void at_most_five_contacts_of_a_joint_are_listed(void **state)
{
    Fixture *fixture = *state;
    Text text;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    const char *section = strstr(text.data, "Strongest contacts, ode");
    assert_non_null(section);
    assert_non_null(strstr(section, " 834.5"));
    assert_null(strstr(section, " 734.5"));
    text_finish(&text);
}

static void a_terminal_sees_headings_and_failures_marked(void **state)
{
    Fixture *fixture = *state;
    static const char *const WORDS[] = {"\x1b[1mCost\x1b[0m", "\x1b[31mFAILED\x1b[0m", NULL};
    Text text;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_TERMINAL, &text);
    expect_words(text.data, WORDS);
    text_finish(&text);
}

static void every_contact_law_is_named(void **state)
{
    Fixture *fixture = *state;
    ContactOptions *contact = &fixture->scenario.contact;
    static const char *const GIVEN[] = {"given stiffness, K = 6.6e+10 N/m^1.5", "viscous 12 N s/m",
                                        NULL};
    static const char *const LOGARITHMIC[] = {"johnson, d = A F (B - ln F)", "damping none\n",
                                              NULL};
    static const char *const POISSON[] = {"poisson, p = 250 N s/m (given), restitution 0.9", NULL};
    static const char *const ESTIMATE[] = {"(the paper's estimate)", "clockwise", NULL};
    Text text;
    text_init(&text);
    contact->stiffness = 6.6e10;
    contact->damping = DAMPING_VISCOUS;
    contact->viscous_coefficient = 12.0;
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, GIVEN);
    contact->stiffness = 0.0;
    contact->law = LAW_JOHNSON;
    contact->damping = DAMPING_NONE;
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, LOGARITHMIC);
    contact->model = CONTACT_POISSON;
    contact->penalty = 250.0;
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, POISSON);
    contact->penalty = 0.0;
    fixture->scenario.linkage.driver.speed = -100.0;
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, ESTIMATE);
    text_finish(&text);
}

static void without_play_there_are_no_contacts_to_list(void **state)
{
    Fixture *fixture = *state;
    fixture->scenario.linkage.joints[1].kind = JOINT_REVOLUTE;
    fixture->runs[1]->joints[1].spike_count = 0;
    fixture->report.summary = NULL;
    fixture->report.stackup = NULL;
    Text text;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    assert_null(strstr(text.data, "Contacts in"));
    assert_null(strstr(text.data, "Strongest"));
    assert_null(strstr(text.data, "takes every joint as ideal"));
    assert_null(strstr(text.data, "Kinematics"));
    text_finish(&text);
}

static void without_a_drive_times_stand_for_crank_angles(void **state)
{
    Fixture *fixture = *state;
    static const char *const WORDS[] = {"at time  omega min", "42.2008  10.0000", "1234  30.0000",
                                        NULL};
    fixture->scenario.linkage.driver.is_present = false;
    fixture->report.summary = NULL;
    fixture->report.stackup = NULL;
    Text text;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, WORDS);
    assert_null(strstr(text.data, "at crank"));
    text_finish(&text);
}

static void what_the_closed_form_cannot_say_is_said_in_a_line(void **state)
{
    Fixture *fixture = *state;
    static const char *const WORDS[] = {
        "\n  no kinematics of the ideal four-bar: it sticks\n",
        "\n  no tolerance stack-up: it sticks within its tolerances\n",
        NULL,
    };
    fixture->report.summary = NULL;
    fixture->report.no_summary = "it sticks";
    fixture->report.stackup = NULL;
    fixture->report.no_stackup = "it sticks within its tolerances";
    Text text;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, WORDS);
    text_finish(&text);
}

static void an_error_is_told_with_what_limits_it(void **state)
{
    TruthFixture *own = *state;
    static const char *const WORDS[] = {
        "in horizon",
        "3e-09",
        "4e-10",
        "limited by the reference",
        "cannot be predicted beyond 20 of 62.83 ms",
        "1e-10 has grown 3.5e+07 times",
        "Contacts matched within the horizon, ode",
        "crank-coupler            30.0000       1234       2.5  -12.5    +6.25",
        "4 of the reference and 5 of ode have no match",
        "Over starts that differ by 0.001 of the speeds",
        "crank-coupler  deepest, um    ode        250000  500000  750000  562500    31250",
        "reference: 16 starts\n",
        "ode: 14 starts, and 2 that failed: a member broke\n",
        "ode                 2    1.25         0.5     0.125    0.0625          0.03125",
        "54321",
        NULL,
    };
    Text text;
    text_init(&text);
    run_text_write(&own->fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, WORDS);
    assert_null(strstr(text.data, "takes every joint as ideal"));
    text_finish(&text);
}

static void a_truth_that_holds_is_told_in_one_line(void **state)
{
    TruthFixture *own = *state;
    static const char *const WORDS[] = {
        "holds through the whole run, 62.83 ms",
        "reference       4e-14       0           0         0     1e-14        1.274e-11\n",
        "ode                 0    1.25         0.5     0.125    0.0625             0.05\n",
        NULL,
    };
    own->truth.is_limited = false;
    own->fixture->report.ensembles = NULL;
    own->fixture->errors[1].max_in_horizon = 4.1e-9;
    // without a drive, or where its work is rounding, the largest energy is another one: kinetic
    // 0.785 mJ, change 1.25 J
    own->fixture->runs[1]->energy.drive_work = 0.0;
    own->fixture->runs[0]->energy = (Energy){.drive_work = 4e-14, .residual = 1e-14};
    Text text;
    text_init(&text);
    run_text_write(&own->fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, WORDS);
    assert_null(strstr(text.data, "cannot be predicted"));
    assert_null(strstr(text.data, "Over starts"));
    assert_null(strstr(text.data, "limited by the reference"));
    assert_null(strstr(text.data, "nan"));
    text_finish(&text);
}

static void a_truth_that_is_not_sure_does_not_hold(void **state)
{
    TruthFixture *own = *state;
    Text text;
    text_init(&text);
    own->truth.is_limited = false;
    own->truth.uncertainty = 2e-3;
    run_text_write(&own->fixture->report, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "own uncertainty is 0.002 over the run"));
    assert_null(strstr(text.data, "holds through"));
    text_finish(&text);
    text_init(&text);
    strcpy(own->truth.message, "the twin left the plane");
    own->truth.is_limited = true;
    own->truth.uncertainty = INFINITY;
    own->fixture->errors[1].max_in_horizon = NAN;
    run_text_write(&own->fixture->report, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "could not be certified: the twin left the plane"));
    assert_null(strstr(text.data, "cannot be predicted"));
    assert_null(strstr(text.data, "nan"));
    assert_null(strstr(text.data, "limited by the reference"));
    text_finish(&text);
}

static void the_law_that_stands_for_poisson_is_named(void **state)
{
    TruthFixture *own = *state;
    Text text;
    text_init(&text);
    own->fixture->scenario.contact.model = CONTACT_POISSON;
    own->fixture->scenario.contact.law = LAW_PAPER_TABLE_3;
    run_text_write(&own->fixture->report, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "the elastic law (paper-table-3) in place of the POISSON"));
    text_finish(&text);
    // the reference alone has no errors, and is no less of another model
    text_init(&text);
    own->fixture->errors[1].is_known = false;
    run_text_write(&own->fixture->report, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "The reference\n\n  The reference has the elastic law"));
    text_finish(&text);
    text_init(&text);
    own->fixture->scenario.contact.model = CONTACT_IMPACT;
    run_text_write(&own->fixture->report, &STYLE_PLAIN, &text);
    assert_null(strstr(text.data, "in place of the POISSON"));
    text_finish(&text);
}

// A reference that failed is no truth: what stands against the closed form contains the play.
static void a_truth_that_cannot_be_had_certifies_nothing(void **state)
{
    TruthFixture *own = *state;
    own->fixture->runs[0]->is_complete = false;
    own->fixture->errors[1].against = "analytic";
    own->fixture->report.matches = NULL;
    own->fixture->report.ensembles = NULL;
    Text text;
    text_init(&text);
    run_text_write(&own->fixture->report, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "takes every joint as ideal"));
    assert_null(strstr(text.data, "reference holds"));
    assert_null(strstr(text.data, "4e-10"));
    text_finish(&text);
}

static void spikes_are_listed_with_what_stands_in_the_bands(void **state)
{
    Fixture *fixture = *state;
    static const char *const WORDS[] = {
        "Spikes of the signals",
        "alpha coupler        rad/s^2  ode          20000      40     -91000     171.9         4   "
        "   60000",
        "force crank-coupler  N        ode           1500       0          -         -         0   "
        "       -",
        "The paper's bands: crank at 120 to 130 and 290 to 300 deg.",
        "Strongest spikes of the accelerations, ode",
        "coupler  11.0000  171.9   -91000    90000     40      2000     -3.5  crank-coupler",
        NULL,
    };
    Text text;
    text_init(&text);
    // nobody looked for any
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    assert_null(strstr(text.data, "Spikes of the signals"));
    text_finish(&text);
    add_spikes(fixture);
    fixture->scenario.has_fourbar = true;
    fixture->scenario.fourbar.ground.nominal = 0.254;
    fixture->scenario.fourbar.crank.nominal = 0.108;
    fixture->scenario.fourbar.coupler.nominal = 0.2794;
    fixture->scenario.fourbar.follower.nominal = 0.2705;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    expect_words(text.data, WORDS);
    text_finish(&text);
    // the paper saw nothing in anybody else's four-bar
    fixture->scenario.fourbar.crank.nominal = 0.109;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "Spikes of the signals"));
    assert_null(strstr(text.data, "bands"));
    text_finish(&text);
    // without a drive there are no angles, and so no bands
    fixture->scenario.has_fourbar = false;
    fixture->scenario.linkage.driver.is_present = false;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "-91000  11.0000\n"));
    assert_null(strstr(text.data, "bands"));
    text_finish(&text);
}

// The bodies behind the first three are the fixture's last, by other names.
static void the_last_of_many_bodies_has_its_spikes(void **state)
{
    Fixture *fixture = *state;
    Linkage *linkage = &fixture->scenario.linkage;
    const size_t last = 15;
    for (size_t i = linkage->body_count; i <= last; i++) {
        linkage->bodies[i] = linkage->bodies[2];
        snprintf(linkage->bodies[i].name, sizeof linkage->bodies[i].name, "link-%zu", i);
    }
    for (size_t i = 0; i < RUNS; i++) {
        size_t room = linkage->body_count;
        fixture->runs[i]->alpha_spikes =
            room_grow(fixture->runs[i]->alpha_spikes, &room, last + 1, sizeof(SignalSpikes));
    }
    Text text;
    text_init(&text);
    linkage->body_count = last + 1;
    spike_tables_write(&fixture->report, RUN_TEXT_SPIKES, &STYLE_PLAIN, &text);
    assert_null(strstr(text.data, "Spikes of the signals"));
    text_finish(&text);
    fixture->runs[1]->alpha_spikes[last] = (SignalSpikes){.is_known = true, .threshold = 2e4};
    text_init(&text);
    spike_tables_write(&fixture->report, RUN_TEXT_SPIKES, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "Spikes of the signals"));
    assert_non_null(strstr(text.data, "alpha link-15"));
    text_finish(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_text_says_what_was_modelled_and_what_came_out,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(springs_torques_and_friction_are_named, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(what_is_rounding_is_shown_as_nothing_and_kept_in_json,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_chosen_step_says_why_its_error_is_not_known_further,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(at_most_five_contacts_of_a_joint_are_listed, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_terminal_sees_headings_and_failures_marked,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(every_contact_law_is_named, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(without_play_there_are_no_contacts_to_list, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(without_a_drive_times_stand_for_crank_angles,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(what_the_closed_form_cannot_say_is_said_in_a_line,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(spikes_are_listed_with_what_stands_in_the_bands,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(the_last_of_many_bodies_has_its_spikes, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(an_error_is_told_with_what_limits_it, truth_fixture_set_up,
                                        truth_fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_truth_that_holds_is_told_in_one_line,
                                        truth_fixture_set_up, truth_fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_truth_that_is_not_sure_does_not_hold,
                                        truth_fixture_set_up, truth_fixture_tear_down),
        cmocka_unit_test_setup_teardown(the_law_that_stands_for_poisson_is_named,
                                        truth_fixture_set_up, truth_fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_truth_that_cannot_be_had_certifies_nothing,
                                        truth_fixture_set_up, truth_fixture_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

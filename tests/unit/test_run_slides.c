// Are sliders, blocks between guides and stops shown in text, JSON and picture, and the tilt at
// which a block jams?
#include "report_fixture.h"

#include <string.h>

static size_t make_block(Fixture *fixture)
{
    const size_t number = 2;
    Joint *joint = &fixture->scenario.linkage.joints[number];
    joint->kind = JOINT_GUIDE;
    joint->guide = (Guide){.opening = 52e-3, .height = 50e-3, .length = 100e-3};
    for (size_t run = 0; run < RUNS; run++) {
        Trajectory *trajectory = fixture->runs[run];
        trajectory->joints[number].tilt_max = (Extreme){.value = 5e-3};
        for (size_t i = 0; i < trajectory->sample_count; i++) {
            trajectory->states[i * trajectory->joint_count + number].tilt = 5e-3;
        }
    }
    return number;
}

static void a_block_jams_where_its_corners_have_no_gap_left(void **state)
{
    (void)state;
    // blocks, and sleeves round a rod
    const Guide guides[] = {{52e-3, 50e-3, 100e-3, {0.0, 0.0}},
                            {10e-3, 9.9e-3, 2e-3, {0.0, 0.0}},
                            {5e-3, 6.2312e-3, 11.6e-3, {0.0, 0.0}}};
    for (size_t i = 0; i < sizeof guides / sizeof *guides; i++) {
        const double tilt = linkage_guide_tilt(&guides[i]);
        assert_near(linkage_guide_gap(&guides[i], 0.0, tilt), 0.0, 1e-16);
        assert_true(linkage_guide_gap(&guides[i], 0.0, 0.999 * tilt) > 0.0);
        // the control: a little further and it is in the metal
        assert_true(linkage_guide_gap(&guides[i], 0.0, 1.001 * tilt) < -1e-9);
    }
    // the woodpecker's sleeve jams as its linear model does, at (r_M - r_O) / h_M
    assert_near(linkage_guide_tilt(&guides[2]), 0.6 / 5.8, 1e-5);
    const Guide loose = {60e-3, 50e-3, 30e-3, {0.0, 0.0}};
    assert_true(linkage_guide_tilt(&loose) == M_PI);
}

static void a_block_has_its_own_lines_and_keys(void **state)
{
    Fixture *fixture = *state;

    Text text;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    // the control: without a block nothing is said of one
    assert_null(strstr(text.data, "Blocks between their guides"));
    assert_null(strstr(text.data, "Sliders along their lines"));
    text_finish(&text);

    const size_t number = make_block(fixture);
    const char *name = fixture->scenario.linkage.joints[number].name;
    text_init(&text);
    run_text_write(&fixture->report, &STYLE_PLAIN, &text);
    assert_non_null(strstr(text.data, "block 50 mm, length 100 mm, guide 52 mm:"));
    assert_non_null(strstr(text.data, "1000 um either way, tilts up to 20.1 mrad"));
    assert_non_null(strstr(text.data, "Blocks between their guides"));
    assert_non_null(strstr(text.data, "Sliders along their lines"));
    text_finish(&text);

    json_t *root = run_json_build(&fixture->report);
    const json_t *run = json_array_get(json_object_get(root, "runs"), 1);
    const json_t *joint = json_object_get(json_object_get(run, "joints"), name);
    assert_near(json_real_value(json_object_get(joint, "tilt_max_rad")), 5e-3, 0.0);
    assert_near(json_real_value(json_object_get(joint, "tilt_limit_rad")), 20.1e-3, 5e-5);
    assert_non_null(json_object_get(joint, "slide_acceleration_max_m_s2"));
    // no other joint slides
    const json_t *pin = json_object_get(json_object_get(run, "joints"), "crank-coupler");
    assert_null(json_object_get(pin, "slide_min_m"));
    json_decref(root);
}

static void a_picture_shows_the_panels_of_the_joints_that_are_there(void **state)
{
    Fixture *fixture = *state;
    static const char *const PANELS[] = {"Block between its guides", "Block across its guides",
                                         "Tilt of the block", "Acceleration of the slider",
                                         "Distance from the stop"};
    for (int with = 0; with < 2; with++) {
        if (with == 1) {
            make_block(fixture);
            fixture->scenario.linkage.joints[3].kind = JOINT_STOP;
        }
        Text svg;
        text_init(&svg);
        plot_run_write(&fixture->report, &svg);
        assert_null(strstr(svg.data, "nan"));
        for (size_t i = 0; i < sizeof PANELS / sizeof *PANELS; i++) {
            assert_int_equal(strstr(svg.data, PANELS[i]) != NULL, with == 1);
        }
        assert_non_null(strstr(svg.data, "Pin in its hole"));
        text_finish(&svg);
    }
}

static void the_legend_has_the_ideal_sliders_that_the_picture_draws(void **state)
{
    Fixture *fixture = *state;
    Joint *joint = &fixture->scenario.linkage.joints[3];
    char words[LINKAGE_NAME_SIZE + 16];
    snprintf(words, sizeof words, ">joint %s<", joint->name);
    // the control: of an ideal pivot beside a pin with play nothing is drawn
    for (int is_slider = 0; is_slider < 2; is_slider++) {
        joint->kind = is_slider == 1 ? JOINT_PRISMATIC : JOINT_REVOLUTE;
        Text svg;
        text_init(&svg);
        plot_run_write(&fixture->report, &svg);
        assert_int_equal(strstr(svg.data, words) != NULL, is_slider == 1);
        text_finish(&svg);
    }
}

static void a_picture_shows_where_limited_coordinates_are(void **state)
{
    Fixture *fixture = *state;
    static const char *const PANELS[] = {"Torque in the joint", "Angle of the joint"};
    Joint *joint = &fixture->scenario.linkage.joints[2];
    for (int is_limited = 0; is_limited < 2; is_limited++) {
        if (is_limited == 1) {
            // the only joint with play
            fixture->scenario.linkage.joints[1].kind = JOINT_REVOLUTE;
            joint->limits = (Limits){.kind = LIMIT_BACKLASH, .backlash = 0.01};
        }
        Text svg;
        text_init(&svg);
        plot_run_write(&fixture->report, &svg);
        for (size_t i = 0; i < sizeof PANELS / sizeof *PANELS; i++) {
            assert_true((strstr(svg.data, PANELS[i]) != NULL) == (is_limited == 1));
        }
        text_finish(&svg);
    }
}

// A gap is a small part of the way between stops: each kind has its own panel.
static void backlash_and_stops_have_panels_of_their_own(void **state)
{
    Fixture *fixture = *state;
    static const char GAP[] = "Angle of the joint in its backlash; dashed: flanks";
    static const char STOPS[] = "Angle of the joint; dashed: stops";
    Joint *joints = fixture->scenario.linkage.joints;
    for (int which = 1; which <= 3; which++) {
        joints[2].limits =
            (Limits){.kind = (which & 1) != 0 ? LIMIT_BACKLASH : LIMIT_NONE, .backlash = 0.01};
        joints[3].limits =
            (Limits){.kind = (which & 2) != 0 ? LIMIT_STOPS : LIMIT_NONE, .low = -2.0, .high = 2.0};
        Text svg;
        text_init(&svg);
        plot_run_write(&fixture->report, &svg);
        assert_int_equal(strstr(svg.data, GAP) != NULL, (which & 1) != 0);
        assert_int_equal(strstr(svg.data, STOPS) != NULL, (which & 2) != 0);
        text_finish(&svg);
    }
}

static void a_stop_says_what_touches_what(void **state)
{
    Fixture *fixture = *state;
    Joint *joint = &fixture->scenario.linkage.joints[3];
    joint->kind = JOINT_STOP;
    static const struct {
        Stop stop;
        const char *words;
    } CASES[] = {
        {{.radius_b = 0.0}, "point against a line"},
        {{.radius_b = 5e-3}, "disc of 10 mm against a line"},
        {{.is_disc = true, .radius_a = 10e-3, .radius_b = 5e-3},
         "disc of 10 mm against a disc of 20 mm"},
        {{.slot = 0.03, .radius_a = 5.1e-3, .radius_b = 5e-3}, "pin of 10 mm in a slot of 10.2 mm"},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        joint->stop = CASES[i].stop;

        Text text;
        text_init(&text);
        run_text_write(&fixture->report, &STYLE_PLAIN, &text);
        assert_non_null(strstr(text.data, CASES[i].words));
        text_finish(&text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_jams_where_its_corners_have_no_gap_left),
        cmocka_unit_test_setup_teardown(a_block_has_its_own_lines_and_keys, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_picture_shows_the_panels_of_the_joints_that_are_there,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(the_legend_has_the_ideal_sliders_that_the_picture_draws,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_picture_shows_where_limited_coordinates_are,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(backlash_and_stops_have_panels_of_their_own, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_stop_says_what_touches_what, fixture_set_up,
                                        fixture_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Does a picture of a study name its columns in words, in the units and on the scales of the study
// file?
#include "commands/study/metrics.h"
#include "commands/study/store.h"
#include "commands/study/study_label.h"

#include "close.h"
#include "scratch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char STUDY[] =
    "title: Labels\n"
    "case: %s/cases/paper/impact-k66.yaml\n"
    "vary:\n"
    "  joints.crank-coupler.radial-clearance: {from: 2 um, to: 500 um, count: 3, scale: log}\n"
    "  drive.speed: [300 rpm, 1000 rpm]\n"
    "  run.step: {from: 1 us, to: 100 us, count: 3}\n"
    "  contact.damping: [none, exact]\n"
    "  scheme: direct/staggered/impulse\n"
    "draw:\n"
    "  count: 2\n"
    "  seed: 1\n"
    "  keys:\n"
    "    four-bar.coupler.length: {log-uniform: [10 in, 12 in]}\n"
    "    contact.restitution: {uniform: [0.8, 0.9]}\n"
    "    contact.stiffness: {uniform: [1e10 N/m^1.5, 7e10 N/m^1.5]}\n";

typedef struct Expected {
    const char *column;
    const char *words;
    const char *unit;
    double per_si;
    bool is_linear;
    bool is_log;
} Expected;

static void assert_label(const Layout *layout, const Spec *spec, const Expected *expected)
{
    const size_t column = store_column(layout, expected->column);
    if (column >= layout->setting_count + layout->result_count) {
        fail_msg("no column %s", expected->column);
    }
    const StudyLabel label = study_label(layout, spec, column);
    assert_string_equal(label.words, expected->words);
    assert_string_equal(label.unit, expected->unit);
    assert_near(label.per_si / expected->per_si, 1.0, 1e-15);
    assert_int_equal(label.is_linear, expected->is_linear);
    assert_int_equal(label.is_log, expected->is_log);
}

static int set_up_labels(void **state)
{
    char path[256];
    char folder[256];
    Err err = {0};
    scratch_path("label.yaml", path, sizeof path);
    assert_non_null(getcwd(folder, sizeof folder));
    FILE *stream = fopen(path, "w");
    fprintf(stream, STUDY, folder);
    fclose(stream);
    Spec *spec = spec_open(path, &err);
    if (spec == NULL) {
        fail_msg("%s", err.text);
    }
    unlink(path);
    *state = spec;
    return 0;
}

static int tear_down_labels(void **state)
{
    spec_close(*state);
    return 0;
}

static void settings_have_the_words_units_and_scales_of_the_study_file(void **state)
{
    static const Expected EXPECTED[] = {
        {"joints_crank_coupler_radial_clearance_m", "radial clearance of crank-coupler", "um", 1e6,
         false, true},
        {"drive_speed_rad_s", "speed of the drive", "rpm", 9.549296585513721, false, false},
        {"run_step_s", "step", "us", 1e6, true, false},
        {"contact_damping", "damping of the contact", "", 1.0, false, false},
        {"scheme", "scheme", "", 1.0, false, false},
        {"four_bar_coupler_length_m", "length of coupler", "in", 1.0 / 0.0254, false, true},
        {"contact_restitution", "restitution of the contact", "", 1.0, true, false},
        {"contact_stiffness_N_m1_5", "stiffness of the contact", "N/m^1.5", 1.0, true, false},
    };
    const Spec *spec = *state;
    Layout *layout = malloc(sizeof *layout);
    metrics_layout(spec, spec->base, layout);
    for (size_t i = 0; i < sizeof EXPECTED / sizeof *EXPECTED; i++) {
        assert_label(layout, spec, &EXPECTED[i]);
    }
    // the control: a store alone knows SI, and no scale
    assert_label(layout, NULL,
                 &(Expected){"joints_crank_coupler_radial_clearance_m",
                             "joints crank coupler radial clearance", "m", 1.0, false, false});
    assert_label(layout, NULL,
                 &(Expected){"drive_speed_rad_s", "drive speed", "rad/s", 1.0, false, false});
    // nor are the words those of a study with other columns
    strcpy(layout->settings[1].name, "drive_pace_rad_s");
    assert_label(layout, spec,
                 &(Expected){"drive_pace_rad_s", "drive pace", "rad/s", 1.0, false, false});
    free(layout);
}

static void results_have_words(void **state)
{
    static const Expected EXPECTED[] = {
        {"follower_omega_max_rad_s", "largest angular velocity of follower", "rad/s", 1.0, false,
         false},
        {"coupler_alpha_min_rad_s2", "smallest angular acceleration of coupler", "rad/s^2", 1.0,
         false, false},
        {"crank_coupler_force_max_N", "largest force of crank-coupler", "N", 1.0, false, false},
        {"crank_coupler_impulse_N_s", "impulse of all contacts of crank-coupler", "N s", 1.0, false,
         false},
        {"crank_coupler_impacts", "contacts begun of crank-coupler", "", 1.0, false, false},
        {"impacts", "contacts begun in all joints", "", 1.0, false, false},
        {"energy_drive_work_J", "work of the drive", "J", 1.0, false, false},
        {"error_max", "largest error of the velocities", "", 1.0, false, false},
        {"error_max_in_horizon", "largest error of the velocities up to the horizon", "", 1.0,
         false, false},
    };
    const Spec *spec = *state;
    Layout *layout = malloc(sizeof *layout);
    metrics_layout(spec, spec->base, layout);
    for (size_t i = 0; i < sizeof EXPECTED / sizeof *EXPECTED; i++) {
        assert_label(layout, spec, &EXPECTED[i]);
    }
    // every result has words of its own that fit beside an axis of 500 pixels, 7 a letter
    for (size_t i = layout->setting_count; i < layout->setting_count + layout->result_count; i++) {
        const StudyLabel label = study_label(layout, spec, i);
        if (strlen(label.words) > 70 || strchr(label.words, '_') != NULL ||
            strncmp(label.words, "the same", 8) == 0) {
            fail_msg("%s: %s", store_column_at(layout, i)->name, label.words);
        }
    }
    // without the study the name of a joint is as its column has it
    assert_label(layout, NULL,
                 &(Expected){"crank_coupler_force_max_N", "largest force of crank_coupler", "N",
                             1.0, false, false});
    free(layout);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(settings_have_the_words_units_and_scales_of_the_study_file,
                                        set_up_labels, tear_down_labels),
        cmocka_unit_test_setup_teardown(results_have_words, set_up_labels, tear_down_labels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

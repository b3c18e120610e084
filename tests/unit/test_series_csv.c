// Does a series hold what the trajectory holds, in the columns that others rely on?
#include "commands/run/run_files.h"
#include "write/series_rows.h"

#include "report_fixture.h"
#include "scratch.h"

#include <stdlib.h>
#include <string.h>

static void a_series_has_the_columns_that_others_rely_on(void **state)
{
    Fixture *fixture = *state;
    char path[256];
    char content[8192];
    Err err = {0};
    scratch_path("series.csv", path, sizeof path);
    assert_true(series_write(&fixture->scenario, fixture->runs[1], NULL, path, &err));
    read_whole(path, content, sizeof content);
    unlink(path);
    char *line = strtok(content, "\n");
    assert_string_equal(
        line, "time_s,crank_deg,crank_angle_rad,crank_omega_rad_s,crank_alpha_rad_s2,"
              "coupler_angle_rad,coupler_omega_rad_s,coupler_alpha_rad_s2,"
              "follower_angle_rad,follower_omega_rad_s,follower_alpha_rad_s2,"
              "ground-crank_ex_m,ground-crank_ey_m,ground-crank_gap_m,ground-crank_force_N,"
              "crank-coupler_ex_m,crank-coupler_ey_m,crank-coupler_gap_m,crank-coupler_force_N,"
              "coupler-follower_ex_m,coupler-follower_ey_m,coupler-follower_gap_m,"
              "coupler-follower_force_N,follower-ground_ex_m,follower-ground_ey_m,"
              "follower-ground_gap_m,follower-ground_force_N,tip_x_m,tip_y_m,"
              "crank_vx_m_s,crank_vy_m_s,coupler_vx_m_s,coupler_vy_m_s,follower_vx_m_s,"
              "follower_vy_m_s,crank-coupler_vx_m_s,crank-coupler_vy_m_s,"
              "crank_x_m,crank_y_m,crank_ax_m_s2,crank_ay_m_s2,"
              "coupler_x_m,coupler_y_m,coupler_ax_m_s2,coupler_ay_m_s2,"
              "follower_x_m,follower_y_m,follower_ax_m_s2,follower_ay_m_s2,"
              "ground-crank_force_x_N,ground-crank_force_y_N,"
              "crank-coupler_force_x_N,crank-coupler_force_y_N,"
              "coupler-follower_force_x_N,coupler-follower_force_y_N,"
              "follower-ground_force_x_N,follower-ground_force_y_N,"
              "crank-coupler_hole_ex_m,crank-coupler_hole_ey_m,crank-coupler_hole_force_x_N,"
              "crank-coupler_hole_force_y_N,crank-coupler_wall_deg,drive_torque_N_m");
    size_t rows = 0;
    while ((line = strtok(NULL, "\n")) != NULL) {
        double values[63];
        char *rest = line;
        for (int i = 0; i < 63; i++) {
            values[i] = strtod(rest, &rest); // 0 of an empty cell
            assert_true(*rest == (i < 62 ? ',' : '\0'));
            rest++;
        }
        // 17 digits bring back every bit
        assert_true(values[0] == fixture->runs[1]->times[rows]);
        assert_true(values[7] == 1.0 / 3.0);
        assert_true(values[15] == 1e-6 * (double)rows);
        assert_true(values[18] == 10.0 * (double)rows);
        assert_near(values[27], 0.25 * cos(0.25 * (double)rows), 1e-15);
        rows++;
    }
    assert_int_equal(rows, SAMPLES);
}

// The number of a column in the head, whose end has been cut.
static size_t column_of(const char *head, const char *name)
{
    size_t column = 0;
    for (const char *word = head; *word != '\0'; word += strcspn(word, ",") + 1, column++) {
        const size_t size = strcspn(word, ",");
        if (size == strlen(name) && strncmp(word, name, size) == 0) {
            return column;
        }
        if (word[size] == '\0') {
            break;
        }
    }
    fail_msg("no column %s", name);
    return 0;
}

// Where a cell begins.
static const char *cell_at(const char *row, size_t column)
{
    for (; column > 0; column--) {
        row = strchr(row, ',') + 1;
    }
    return row;
}

static double cell(const char *row, size_t column)
{
    return strtod(cell_at(row, column), NULL);
}

static void ranges_stand_behind_the_samples(void **state)
{
    Fixture *fixture = *state;
    Trajectory *run = fixture->runs[1];
    trajectory_keep_ranges(run, &fixture->scenario);
    const double interval_s = scenario_sample_time(&fixture->scenario, 1);
    const size_t alpha = ranges_of_body(1, RANGES_ALPHA);
    const size_t force = ranges_of_joint(&run->ranges, 1, RANGES_FORCE);
    // two spikes between the second and the third sample, and a value at the border before them
    ranges_add(&run->ranges, alpha, 1.3 * interval_s, -7e5);
    ranges_add(&run->ranges, alpha, 1.9 * interval_s, 2e5);
    ranges_add(&run->ranges, force, interval_s, 123.0);
    char path[256];
    static char content[32768];
    Err err = {0};
    scratch_path("ranges.csv", path, sizeof path);
    assert_true(series_write(&fixture->scenario, run, NULL, path, &err));
    read_whole(path, content, sizeof content);
    unlink(path);
    char *rows[SAMPLES + 1];
    rows[0] = strtok(content, "\n");
    for (int i = 1; i <= SAMPLES; i++) {
        rows[i] = strtok(NULL, "\n");
    }
    assert_non_null(strstr(rows[0], ",tip_x_m,tip_y_m,crank_vx_m_s,crank_vy_m_s,"));
    assert_non_null(strstr(rows[0], "follower-ground_force_min_N,follower-ground_force_max_N"));
    const size_t least = column_of(rows[0], "coupler_alpha_min_rad_s2");
    const size_t most = column_of(rows[0], "coupler_alpha_max_rad_s2");
    assert_true(cell(rows[2], least) == -7e5);
    assert_true(cell(rows[2], most) == 2e5);
    const size_t pressed = column_of(rows[0], "crank-coupler_force_max_N");
    assert_true(cell(rows[1], pressed) == 123.0);
    assert_true(cell(rows[2], pressed) == 123.0);
    // the control: the samples do not know them
    assert_true(cell(rows[2], column_of(rows[0], "coupler_alpha_rad_s2")) == 1.0 / 3.0);
}

static void a_number_that_does_not_exist_is_an_empty_cell(void **state)
{
    Fixture *fixture = *state;
    Trajectory *run = fixture->runs[1];
    Sample sample = sample_create(&fixture->scenario.linkage);
    sample.time_s = run->times[1];
    sample.bodies[1].omega = 3.5;
    sample.bodies[1].alpha = INFINITY;
    sample.joints[1].force = NAN;
    trajectory_store(run, 1, &sample);
    sample_free(&sample);
    char path[256];
    static char content[8192];
    Err err = {0};
    scratch_path("none.csv", path, sizeof path);
    assert_true(series_write(&fixture->scenario, run, NULL, path, &err));
    read_whole(path, content, sizeof content);
    unlink(path);
    const char *head = strtok(content, "\n");
    const char *none_above = strtok(NULL, "\n");
    const char *row = strtok(NULL, "\n");
    assert_true(cell(row, column_of(head, "coupler_omega_rad_s")) == 3.5);
    assert_int_equal(*cell_at(row, column_of(head, "coupler_alpha_rad_s2")), ',');
    assert_int_equal(*cell_at(row, column_of(head, "crank-coupler_force_N")), ',');
    assert_true(cell(none_above, column_of(head, "coupler_alpha_rad_s2")) == 1.0 / 3.0);
}

static void columns_are_chosen_by_name(void **state)
{
    Fixture *fixture = *state;
    static char content[32768];
    char path[256];
    Err err = {0};
    scratch_path("chosen.csv", path, sizeof path);
    assert_true(series_write(&fixture->scenario, fixture->runs[1], "coupler_a?pha*, *_force_N",
                             path, &err));
    read_whole(path, content, sizeof content);
    unlink(path);
    // in the order of the series
    assert_string_equal(strtok(content, "\n"),
                        "time_s,coupler_alpha_rad_s2,ground-crank_force_N,crank-coupler_force_N,"
                        "coupler-follower_force_N,follower-ground_force_N");
    const char *row = strtok(NULL, "\n");
    assert_true(cell(row, 0) == fixture->runs[1]->times[0]);
    assert_true(cell(row, 1) == 1.0 / 3.0);

    SeriesColumns columns = series_columns_create(&fixture->scenario, false);
    assert_true(series_columns_check(&columns, "time_s,crank*", &err));
    assert_false(series_columns_check(&columns, "time_s,coupler_omega", &err));
    assert_int_equal(err.kind, ERR_USAGE);
    assert_string_equal(err.text,
                        "--columns: no column is called 'coupler_omega'; did you mean "
                        "'coupler_omega_rad_s'? * stands for any letters, and the file without "
                        "--columns begins with all names");
    assert_false(series_columns_check(&columns, "time_s,", &err));
    assert_false(series_columns_check(&columns, "", &err));
    series_columns_finish(&columns);
}

static void columns_of_one_name_are_told_apart(void **state)
{
    Fixture *fixture = *state;
    Scenario scenario = fixture->scenario;
    strcpy(scenario.points[0].name, "coupler"); // as a body is
    SeriesColumns columns = series_columns_create(&scenario, false);
    Err err = {0};
    assert_true(series_columns_check(&columns, "coupler_x_m,coupler_x_m_2,coupler_y_m_2", &err));
    assert_false(series_columns_check(&columns, "coupler_x_m_3", &err));
    series_columns_finish(&columns);
}

static void a_series_of_several_runs_has_a_file_each(void **state)
{
    (void)state;
    char path[64];
    series_path("out.csv", "ode", 1, path, sizeof path);
    assert_string_equal(path, "out.csv");
    series_path("a.b/out.csv", "ode", 2, path, sizeof path);
    assert_string_equal(path, "a.b/out-ode.csv");
    series_path("a.b/out", "ode", 2, path, sizeof path);
    assert_string_equal(path, "a.b/out-ode");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_series_has_the_columns_that_others_rely_on,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(ranges_stand_behind_the_samples, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_number_that_does_not_exist_is_an_empty_cell,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(columns_are_chosen_by_name, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(columns_of_one_name_are_told_apart, fixture_set_up,
                                        fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_series_of_several_runs_has_a_file_each, fixture_set_up,
                                        fixture_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Does a series hold what the trajectory holds, in the columns that others rely on?
#include "report/series_csv.h"

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
    assert_true(series_csv_write(&fixture->scenario, fixture->runs[1], path, &err));
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
              "follower-ground_gap_m,follower-ground_force_N,tip_x_m,tip_y_m");
    size_t rows = 0;
    while ((line = strtok(NULL, "\n")) != NULL) {
        double values[29];
        char *rest = line;
        for (int i = 0; i < 29; i++) {
            values[i] = strtod(rest, &rest);
            assert_true(*rest == (i < 28 ? ',' : '\0'));
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

static void a_series_of_several_runs_has_a_file_each(void **state)
{
    (void)state;
    char path[64];
    series_csv_path("out.csv", "ode", 1, path, sizeof path);
    assert_string_equal(path, "out.csv");
    series_csv_path("a.b/out.csv", "ode", 2, path, sizeof path);
    assert_string_equal(path, "a.b/out-ode.csv");
    series_csv_path("a.b/out", "ode", 2, path, sizeof path);
    assert_string_equal(path, "a.b/out-ode");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_series_has_the_columns_that_others_rely_on,
                                        fixture_set_up, fixture_tear_down),
        cmocka_unit_test_setup_teardown(a_series_of_several_runs_has_a_file_each, fixture_set_up,
                                        fixture_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

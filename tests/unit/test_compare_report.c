// Is everything about a comparison told, in words, numbers and a picture?
#include "commands/compare/compare.h"
#include "write/file.h"

#include "close.h"
#include "kept.h"
#include "mechanism.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { STEPS = 4, REPEATS = 5 };

typedef struct Fixture {
    Scenario scenario;
    Ladder *ladder;
    CompareReport report;
    Text text;
} Fixture;

static void add_runs(Ladder *ladder)
{
    for (size_t i = 0; i < ladder_run_total(ladder); i++) {
        LadderRun run = ladder_run(ladder, i);
        const LadderPoint *point = &ladder->points[run.point];
        const double step_s = point->step_s > 0.0 ? point->step_s : 1e-5;
        run.is_complete = run.point != 5;
        strcpy(run.message, run.is_complete ? "" : "at 1 ms: the \"pin\", alas, has left");
        run.error = (TrajectoryError){.is_known = true,
                                      .max = 100.0 * step_s,
                                      .max_in_horizon = 50.0 * step_s,
                                      .omega_rms = step_s,
                                      .alpha_max = INFINITY};
        run.steps = (size_t)(0.06 / step_s);
        run.evaluations = point->step_s > 0.0 ? 0 : 4321;
        run.wall_s = (1.0 + (double)point->scheme) * 0.06e-6 / step_s;
        ladder_add(ladder, &run);
    }
}

static int set_up(void **state)
{
    static const Scheme SCHEMES[3] = {
        {.name = "direct/plain/textbook", .backend = BACKEND_ODE},
        {.name = "quick/plain/textbook", .backend = BACKEND_ODE, .solver = ODE_QUICK},
        {.name = "reference", .backend = BACKEND_REFERENCE}};
    static const double STEP_LIST[STEPS] = {1e-5, 3e-6, 1e-6, 3e-7};
    Fixture *fixture = calloc(1, sizeof *fixture);
    fixture->scenario = mechanism_paper();
    mechanism_loosen(&fixture->scenario, "crank-coupler");
    strcpy(fixture->scenario.title, "Play & <nothing> else");
    kept_set_path(&fixture->scenario, "cases/test.yaml");
    fixture->ladder = ladder_create(SCHEMES, 3, STEP_LIST, STEPS, REPEATS);
    fixture->ladder->truth = (LadderTruth){true, "reference", 4e-6, 0.025, 2e4, true, 1.5, ""};
    add_runs(fixture->ladder);
    for (size_t i = 0; i < 3; i++) {
        LadderEnsemble *ensemble = &fixture->ladder->ensembles[i];
        ensemble->is_known = true;
        ensemble->step_s = i < 2 ? 3e-7 : 0.0;
        ensemble->ensemble.members = i == 1 ? 0 : ENSEMBLE_MEMBERS;
        ensemble->ensemble.failed = i == 1 ? ENSEMBLE_MEMBERS : 0;
        strcpy(ensemble->ensemble.message, i == 1 ? "all of them left" : "");
        ensemble->ensemble.joints[1][ENSEMBLE_PENETRATION_MAX] =
            (Distribution){1e-6, 2e-6, 3e-6, 2e-6, 5e-7};
    }
    ladder_conclude(fixture->ladder);
    fixture->report =
        (CompareReport){&fixture->scenario, fixture->ladder, "A Processor", {0.0, 0.0}};
    text_init(&fixture->text);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    Fixture *fixture = *state;
    text_finish(&fixture->text);
    ladder_destroy(fixture->ladder);
    free(fixture);
    return 0;
}

static void assert_has(const char *text, const char *words)
{
    if (strstr(text, words) == NULL) {
        print_error("'%s' is not in:\n%s\n", words, text);
        fail();
    }
}

static void people_read_of_truth_points_orders_and_the_cheapest(void **state)
{
    Fixture *fixture = *state;
    compare_text_write(&fixture->report, &STYLE_PLAIN, &fixture->text);
    const char *text = fixture->text.data;
    assert_has(text, "truth       reference, to 4e-06; made");
    assert_has(text, "horizon     25 ms of 60 ms");
    assert_has(text, "median of 5 runs, taken in turn, on A Processor");
    assert_has(text, "frontier, truth-limited");
    assert_has(text, "failed");
    assert_has(text, "quick/plain/textbook, 3 us failed: at 1 ms: the \"pin\", alas, has left");
    assert_has(text, "direct/plain/textbook   1.00         10        1       3    0.00");
    assert_has(text, "quick/plain/textbook    none");
    assert_has(text, "none of these");
    assert_has(text, "For comparison: reference, error 4.0e-06");
    assert_has(text, "their speeds a little apart");
    assert_has(text, "2 [1, 3]");
    assert_has(text, "16 of the ensemble's runs failed: all of them left");
}

static void without_a_horizon_nothing_lies_beyond(void **state)
{
    Fixture *fixture = *state;
    fixture->ladder->truth.is_limited = false;
    fixture->scenario.title[0] = '\0';
    fixture->scenario.contact.model = CONTACT_POISSON;
    compare_text_write(&fixture->report, &STYLE_PLAIN, &fixture->text);
    assert_null(strstr(fixture->text.data, "horizon"));
    assert_null(strstr(fixture->text.data, "apart"));
    assert_has(fixture->text.data, "A case without a title");
    assert_has(fixture->text.data, "difference of the two models");
}

static void a_truth_that_could_not_be_certified_has_no_horizon(void **state)
{
    Fixture *fixture = *state;
    LadderTruth *truth = &fixture->ladder->truth;
    strcpy(truth->message, "the tighter run left the plane");
    truth->uncertainty = INFINITY;
    for (size_t i = 0; i < fixture->ladder->point_count; i++) {
        fixture->ladder->points[i].run.error.max_in_horizon = NAN;
    }
    ladder_conclude(fixture->ladder);
    compare_text_write(&fixture->report, &STYLE_PLAIN, &fixture->text);
    const char *text = fixture->text.data;
    assert_has(text, "could not be certified: the tighter run left the plane");
    assert_has(text, "direct/plain/textbook has no error: the truth could not be certified");
    assert_has(text, "For comparison: reference, without an error in");
    assert_null(strstr(text, "horizon"));
    assert_null(strstr(text, "nan"));
    assert_null(strstr(text, "inf "));
    assert_null(strstr(text, "frontier  "));
    json_t *root = compare_json_build(&fixture->report);
    const json_t *object = json_object_get(root, "truth");
    assert_string_equal(json_string_value(json_object_get(object, "message")),
                        "could not be certified: the tighter run left the plane");
    assert_true(json_is_null(json_object_get(object, "horizon_s")));
    const json_t *point = json_array_get(
        json_object_get(json_array_get(json_object_get(root, "schemes"), 0), "points"), 0);
    assert_string_equal(json_string_value(json_object_get(point, "status")), "ok");
    assert_true(json_is_null(json_object_get(point, "error_max")));
    assert_true(json_is_true(json_object_get(point, "on_frontier")) == 0);
    json_decref(root);
    text_finish(&fixture->text);
    text_init(&fixture->text);
    compare_plot_write(&fixture->report, &fixture->text);
    assert_has(fixture->text.data, "which could not be certified");
    assert_null(strstr(fixture->text.data, "nan"));
    assert_null(strstr(fixture->text.data, "inf"));
}

static const json_t *at(const json_t *root, const char *list, size_t index)
{
    return json_array_get(json_object_get(root, list), index);
}

static double number(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

static void programs_read_the_same(void **state)
{
    Fixture *fixture = *state;
    json_t *root = compare_json_build(&fixture->report);
    assert_near(number(json_object_get(root, "truth"), "uncertainty"), 4e-6, 0.0);
    assert_true(json_is_true(json_object_get(json_object_get(root, "truth"), "is_limited")));
    assert_non_null(json_object_get(json_object_get(root, "settings"), "run.step"));
    assert_int_equal(json_array_size(json_object_get(root, "schemes")), 3);
    const json_t *direct = at(root, "schemes", 0);
    assert_string_equal(json_string_value(json_object_get(direct, "map")), "textbook");
    assert_near(number(json_object_get(direct, "order"), "order"), 1.0, 1e-9);
    const json_t *point = at(direct, "points", 0);
    assert_near(number(point, "error_max"), 5e-4, 1e-15);
    assert_near(number(json_object_get(point, "error"), "max"), 1e-3, 1e-15);
    assert_true(json_is_null(json_object_get(json_object_get(point, "error"), "alpha_max")));
    assert_int_equal(json_array_size(json_object_get(point, "wall_s")), REPEATS);
    assert_true(json_is_true(json_object_get(point, "on_frontier")));
    const json_t *failed = at(at(root, "schemes", 1), "points", 1);
    assert_string_equal(json_string_value(json_object_get(failed, "status")), "failed");
    assert_null(json_object_get(failed, "error"));
    assert_true(json_is_null(json_object_get(at(root, "schemes", 1), "order")));
    const json_t *reference = at(root, "schemes", 2);
    assert_null(json_object_get(reference, "map"));
    assert_true(json_is_null(json_object_get(at(reference, "points", 0), "step_s")));
    const json_t *ensemble = json_object_get(reference, "ensemble");
    assert_int_equal(json_integer_value(json_object_get(ensemble, "members")), ENSEMBLE_MEMBERS);
    assert_non_null(json_object_get(json_object_get(ensemble, "joints"), "crank-coupler"));
    assert_true(json_is_null(json_object_get(at(root, "cheapest", 3), "scheme")));
    assert_near(number(at(root, "cheapest", 0), "step_s"), 1e-5, 0.0);
    json_decref(root);
    fixture->ladder->ensembles[0].is_known = false;
    root = compare_json_build(&fixture->report);
    assert_true(json_is_null(json_object_get(at(root, "schemes", 0), "ensemble")));
    json_decref(root);
}

static size_t count_cells(const char *line)
{
    size_t cells = 1;
    bool is_quoted = false;
    for (; *line != '\0' && *line != '\n'; line++) {
        is_quoted = *line == '"' ? !is_quoted : is_quoted;
        cells += *line == ',' && !is_quoted ? 1 : 0;
    }
    return cells;
}

// Makes an empty file by a pattern that ends in XXXXXX, and puts its name there.
static void make_file(char *path)
{
    const int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
}

static void a_spreadsheet_has_as_many_cells_in_every_row(void **state)
{
    Fixture *fixture = *state;
    char path[] = "/tmp/compare-XXXXXX";
    make_file(path);
    Err err = {0};
    // a point without an error has an empty cell and its reason
    fixture->ladder->points[0].run.error.max_in_horizon = NAN;
    ladder_conclude(fixture->ladder);
    assert_true(compare_rows_write_csv(&fixture->report, path, &err));
    char line[4096];
    FILE *stream = fopen(path, "r");
    size_t lines = 0;
    size_t cells = 0;
    while (fgets(line, sizeof line, stream) != NULL) {
        cells = lines == 0 ? count_cells(line) : cells;
        assert_int_equal(count_cells(line), cells);
        if (lines == 1) {
            assert_has(line, "ok,5999,0,,0,");
            assert_has(line, "\"has no error: no sample lies within the horizon\"");
        }
        if (lines == 6) {
            assert_has(line, "\"at 1 ms: the \"\"pin\"\", alas, has left\"");
        }
        lines++;
    }
    fclose(stream);
    unlink(path);
    assert_int_equal(lines, 1 + fixture->ladder->point_count);
    assert_false(compare_rows_write_csv(&fixture->report, "/nowhere/at/all.csv", &err));
    assert_int_equal(err.kind, ERR_FILE);
}

// The cell of a row by its column in the head; empty where there is none. Cells before it have no
// quotes.
static const char *cell_of(const char *head, const char *row, const char *name)
{
    static char cell[256];
    const char *at = strstr(head, name);
    assert_non_null(at);
    for (const char *comma = head; comma < at; comma++) {
        row += *comma == ',' ? strcspn(row, ",") + 1 : 0;
    }
    snprintf(cell, sizeof cell, "%.*s", (int)strcspn(row, ",\n"), row);
    return cell;
}

static void a_number_that_does_not_exist_is_an_empty_cell_and_null(void **state)
{
    Fixture *fixture = *state;
    char path[] = "/tmp/compare-XXXXXX";
    make_file(path);
    Err err = {0};
    fixture->ladder->points[1].run.error.alpha_max = NAN;
    fixture->ladder->points[2].run.error.alpha_max = 0.25;
    assert_true(compare_rows_write_csv(&fixture->report, path, &err));
    json_t *root = compare_json_build(&fixture->report);
    const json_t *scheme = json_array_get(json_object_get(root, "schemes"), 0);
    const json_t *points = json_object_get(scheme, "points");
    char head[4096];
    char row[4096];
    FILE *stream = fopen(path, "r");
    assert_non_null(fgets(head, sizeof head, stream));
    for (size_t i = 0; i < 3; i++) {
        assert_non_null(fgets(row, sizeof row, stream));
        const json_t *error = json_object_get(json_array_get(points, i), "error");
        assert_int_equal(json_is_null(json_object_get(error, "alpha_max")), i < 2);
        assert_string_equal(cell_of(head, row, "alpha_max"), i < 2 ? "" : "0.25");
        // the control: the cell before it is a number
        assert_true(strtod(cell_of(head, row, "omega_rms"), NULL) > 0.0);
    }
    fclose(stream);
    unlink(path);
    json_decref(root);
}

static void the_picture_has_lines_frontier_band_and_arrow(void **state)
{
    Fixture *fixture = *state;
    compare_plot_write(&fixture->report, &fixture->text);
    const char *svg = fixture->text.data;
    assert_has(svg, "Play &amp; &lt;nothing&gt; else");
    assert_has(svg, "limited by the truth");
    assert_has(svg, ">direct/plain/textbook</text>");
    assert_has(svg, ">order 1.00</text>");
    assert_has(svg, ">no order, 1 failed</text>");
    assert_has(svg, ">0.3 us</text>");
    assert_has(svg, "reference, 4e-06");
    assert_has(svg, "up to its horizon at 25 ms of 60");
    assert_null(strstr(svg, "nan"));
    assert_null(strstr(svg, "inf\""));
}

// the stair of the frontier goes from fast and wrong to slow and right: to the right and down
static void the_frontier_goes_down_to_the_right(void **state)
{
    Fixture *fixture = *state;
    // a point of the second scheme comes between two of the first
    LadderPoint *between = &fixture->ladder->points[STEPS];
    between->run.error.max *= 0.6;
    between->run.error.max_in_horizon *= 0.6;
    ladder_conclude(fixture->ladder);
    assert_true(between->is_on_frontier);
    compare_plot_write(&fixture->report, &fixture->text);
    const char *stair = strstr(fixture->text.data, "stroke-linecap=\"round\" d=\"M");
    assert_non_null(stair);
    double x = 0.0, y = 0.0;
    int end = 0;
    stair = strchr(stair, 'M');
    assert_int_equal(sscanf(stair, "M%lf %lf%n", &x, &y, &end), 2);
    int points = 1;
    double next_x = 0.0, next_y = 0.0;
    for (stair += end; sscanf(stair, "H%lfV%lf%n", &next_x, &next_y, &end) == 2; stair += end) {
        assert_true(next_x > x && next_y > y);
        x = next_x;
        y = next_y;
        points++;
    }
    assert_true(points > 2);
}

static void a_picture_of_nothing_is_still_a_picture(void **state)
{
    Fixture *fixture = *state;
    for (size_t i = 0; i < fixture->ladder->point_count; i++) {
        fixture->ladder->points[i].run.is_complete = false;
    }
    ladder_conclude(fixture->ladder);
    compare_plot_write(&fixture->report, &fixture->text);
    assert_has(fixture->text.data, "no order, 4 failed");
    assert_has(fixture->text.data, "</svg>");
    assert_null(strstr(fixture->text.data, "nan"));
}

#define REPORT_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        REPORT_TEST(people_read_of_truth_points_orders_and_the_cheapest),
        REPORT_TEST(without_a_horizon_nothing_lies_beyond),
        REPORT_TEST(a_truth_that_could_not_be_certified_has_no_horizon),
        REPORT_TEST(programs_read_the_same),
        REPORT_TEST(a_spreadsheet_has_as_many_cells_in_every_row),
        REPORT_TEST(a_number_that_does_not_exist_is_an_empty_cell_and_null),
        REPORT_TEST(the_picture_has_lines_frontier_band_and_arrow),
        REPORT_TEST(the_frontier_goes_down_to_the_right),
        REPORT_TEST(a_picture_of_nothing_is_still_a_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

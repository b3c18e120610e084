// Do the exports, the tables and the pictures of a study say what is in its store?
#include "commands/study/study.h"
#include "commands/study/study_plot.h"

#include "scratch.h"
#include "study_store.h"

#include <jansson.h>

enum { CONTENT_SIZE = 1 << 18 };

static char out[PATH_SIZE];
static char written[CONTENT_SIZE];

static int set_up_out(void **state)
{
    const int status = set_up(state);
    snprintf(out, sizeof out, "%s/out", folder);
    return status;
}

static int tear_down_out(void **state)
{
    unlink(out);
    return tear_down(state);
}

static Store *view(void)
{
    Err err = {0};
    Store *store = store_view(path, &err);
    assert_string_equal(err.text, "");
    return store;
}

static char *next_cell(char **rest)
{
    char *cell = *rest;
    char *end = cell + strcspn(cell, ",\n");
    *rest = end + 1;
    *end = '\0';
    return cell;
}

static void expect_number(const char *cell, double truth)
{
    if (isnan(truth)) {
        assert_string_equal(cell, "");
    } else {
        assert_near(strtod(cell, NULL), truth, 0.0);
    }
}

static void csv_brings_back_every_number(void **state)
{
    (void)state;
    Err err = {0};
    const Layout layout = study_layout();
    make_store(60);
    Store *store = view();
    assert_true(study_rows_write_csv(store, out, &err));
    store_close(store, &err);
    read_whole(out, written, sizeof written);
    static const char HEAD[] =
        "run,drive_speed_rad_s,contact_damping,scheme,run_step_s,outcome,reason,coupler_omega_max";
    assert_int_equal(strncmp(written, HEAD, sizeof HEAD - 1), 0);
    char *rest = strchr(written, '\n') + 1;
    for (uint64_t run = 0; run < 60; run++) {
        const Record truth = study_record(&layout, run);
        char hash[32] = "";
        if (truth.hash != 0) {
            snprintf(hash, sizeof hash, "%016llx", (unsigned long long)truth.hash);
        }
        expect_number(next_cell(&rest), (double)run);
        expect_number(next_cell(&rest), truth.settings[0].number);
        assert_string_equal(next_cell(&rest), truth.settings[1].word);
        assert_string_equal(next_cell(&rest), truth.settings[2].word);
        expect_number(next_cell(&rest), truth.settings[3].number);
        assert_string_equal(next_cell(&rest), RUN_OUTCOME_WORDS[truth.outcome]);
        assert_string_equal(next_cell(&rest), truth.reason);
        for (size_t i = 0; i < layout.result_count; i++) {
            expect_number(next_cell(&rest), truth.results[i]);
        }
        assert_string_equal(next_cell(&rest), hash);
        expect_number(next_cell(&rest), truth.wall_s);
    }
    assert_string_equal(rest, "");
}

static void json_lines_bring_back_every_number(void **state)
{
    (void)state;
    Err err = {0};
    const Layout layout = study_layout();
    make_store(60);
    Store *store = view();
    assert_true(study_rows_write_jsonl(store, out, &err));
    store_close(store, &err);
    FILE *stream = fopen(out, "r");
    for (uint64_t run = 0; run < 60; run++) {
        const Record truth = study_record(&layout, run);
        json_t *row = json_loadf(stream, JSON_DISABLE_EOF_CHECK, NULL);
        assert_non_null(row);
        assert_int_equal(json_object_size(row), 1 + 4 + 2 + layout.result_count + 2);
        assert_int_equal(json_integer_value(json_object_get(row, "run")), run);
        assert_string_equal(json_string_value(json_object_get(row, "scheme")),
                            truth.settings[2].word);
        assert_string_equal(json_string_value(json_object_get(row, "outcome")),
                            RUN_OUTCOME_WORDS[truth.outcome]);
        assert_int_equal(json_is_null(json_object_get(row, "reason")),
                         truth.outcome == RUN_OUTCOME_OK);
        for (size_t i = 0; i < layout.result_count; i++) {
            const json_t *value = json_object_get(row, layout.results[i].name);
            assert_int_equal(json_is_null(value), isnan(truth.results[i]));
            assert_true(json_is_null(value) || json_number_value(value) == truth.results[i]);
            assert_true(json_is_null(value) ||
                        json_is_integer(value) == (layout.results[i].kind == COLUMN_WHOLE));
        }
        json_decref(row);
    }
    fclose(stream);
}

static void an_infinity_is_an_empty_cell_and_null(void **state)
{
    (void)state;
    Err err = {0};
    const Layout layout = study_layout();
    Store *store = open_study(&layout, false, &err);
    assert_non_null(store);
    Record record = study_record(&layout, 0);
    record.results[0] = INFINITY;
    record.results[1] = 0.5;
    assert_true(store_add(store, &record, &err));
    assert_true(store_close(store, &err));
    store = view();
    assert_true(study_rows_write_csv(store, out, &err));
    read_whole(out, written, sizeof written);
    char *rest = strchr(written, '\n') + 1;
    for (size_t i = 0; i < 1 + layout.setting_count + 2; i++) {
        next_cell(&rest);
    }
    assert_string_equal(next_cell(&rest), "");
    assert_string_equal(next_cell(&rest), "0.5");
    unlink(out);
    assert_true(study_rows_write_jsonl(store, out, &err));
    store_close(store, &err);
    read_whole(out, written, sizeof written);
    json_t *row = json_loads(written, 0, NULL);
    assert_true(json_is_null(json_object_get(row, layout.results[0].name)));
    json_decref(row);
}

static void an_export_never_writes_over_its_store(void **state)
{
    (void)state;
    Err err = {0};
    make_store(20);
    Store *store = view();
    assert_false(study_rows_write_csv(store, path, &err));
    assert_int_equal(err.kind, ERR_USAGE);
    err = (Err){0};
    assert_false(study_rows_write_jsonl(store, path, &err));
    assert_non_null(strstr(err.text, "which is the store that this command reads"));
    err = (Err){0};
    assert_false(study_rows_write_csv(store, "/dev/full", &err));
    assert_int_equal(err.kind, ERR_FILE);
    err = (Err){0};
    store_close(store, &err);
    assert_int_equal(count_right_rows(), 20);
}

#define assert_has(text, words) assert_non_null(strstr((text).data, (words)))

static void status_counts_outcomes_and_reasons(void **state)
{
    (void)state;
    Err err = {0};
    Text text;
    text_init(&text);
    make_store(110);
    Store *store = view();
    const StudyPart parts[] = {{"a.1-of-2.sqlite", store, 120}, {"a.2-of-2.sqlite", NULL, 80}};
    assert_true(study_text_status(parts, 2, "here", &STYLE_PLAIN, &text, &err));
    assert_has(text, "110 of 200 runs are over (55.0 %)");
    assert_has(text, "a.1-of-2.sqlite   120   110   91.7       3");
    assert_has(text, "not begun");
    assert_has(text, "timed out     1   0.91");
    assert_has(text, "2  failed     a number is not finite at 0.0125 s            7");
    // the most frequent reason first
    assert_has(text, "1  timed out  ");
    assert_true(strstr(text.data, "2  failed") < strstr(text.data, "1  timed out  "));
    assert_has(text, "one core has");
    store_close(store, &err);
    text_finish(&text);
}

static void the_summary_has_a_row_a_result(void **state)
{
    (void)state;
    Err err = {0};
    Text text;
    StoreSpread spread;
    char words[64];
    text_init(&text);
    make_store(RUNS);
    Store *store = view();
    assert_true(study_text_summary(store, true, &STYLE_PLAIN, &text, &err));
    assert_true(store_spread(store, 4, &spread, &err));
    snprintf(words, sizeof words, "%.4g", spread.median);
    assert_has(text, words);
    assert_has(text, "evaluations");
    store_close(store, &err);
    text_finish(&text);
}

// The main numbers alone; those that no run has are left out everywhere.
static void the_summary_has_the_main_results(void **state)
{
    (void)state;
    Err err = {0};
    Text text;
    text_init(&text);
    make_store(RUNS);
    Store *store = view();
    assert_true(study_text_summary(store, false, &STYLE_PLAIN, &text, &err));
    assert_null(strstr(text.data, "evaluations"));
    assert_has(text, "--full shows them");
    store_close(store, &err);
    text_finish(&text);
}

static size_t count_words(const char *text, const char *words)
{
    size_t count = 0;
    for (const char *at = strstr(text, words); at != NULL; at = strstr(at + 1, words)) {
        count++;
    }
    return count;
}

// The picture; its text is freed by the caller.
static Text draw_picture(const char *x, const char *y, const char *by)
{
    Err err = {0};
    Text svg;
    text_init(&svg);
    Store *store = view();
    const StudyPlot plot = {.x = x, .y = y, .by = by};
    assert_true(study_plot_write(store, &plot, NULL, &svg, &err));
    store_close(store, &err);
    assert_has(svg, "</svg>");
    return svg;
}

static void a_picture_has_lines_on_a_grid_and_dots_elsewhere(void **state)
{
    (void)state;
    make_store(RUNS);
    // eight steps, shared by many runs: a median each and two lines, with bands
    Text svg = draw_picture("run_step_s", "error_max", "scheme");
    assert_int_equal(count_words(svg.data, "<circle"), 2 * 8 + 2);
    assert_int_equal(count_words(svg.data, "fill-opacity=\"0.16\""), 2);
    assert_has(svg, "196 runs: median, and the band that nine of ten lie in");
    assert_has(svg, "4 without a result left out");
    text_finish(&svg);
    // a result has a value of its own in each run
    svg = draw_picture("coupler_omega_max_rad_s", "error_max", NULL);
    assert_true(count_words(svg.data, "<circle") > 180);
    assert_int_equal(count_words(svg.data, "fill-opacity=\"0.16\""), 0);
    assert_has(svg, "a dot each");
    text_finish(&svg);
}

static void a_picture_of_one_column_is_its_distribution(void **state)
{
    (void)state;
    make_store(RUNS);
    Text svg = draw_picture("error_max", NULL, NULL);
    assert_has(svg, "share of the runs, %");
    assert_has(svg, "median ");
    assert_int_equal(count_words(svg.data, "fill-opacity=\"0.16\""), 1);
    text_finish(&svg);
    // one value alone is one bar
    svg = draw_picture("drive_speed_rad_s", NULL, "contact_damping");
    assert_has(svg, "lankarani-nikravesh");
    text_finish(&svg);
}

static void what_cannot_be_drawn_is_told(void **state)
{
    (void)state;
    static const StudyPlot PLOTS[] = {
        {NULL, "scheme", NULL, NULL, false},
        {NULL, "run_step", "steps", NULL, false},
        {NULL, "run_step_s", "steps", "steps", false},
        {NULL, "run_step_s", "steps", "drive_speed_rad_s", false},
    };
    static const char *const WORDS[] = {
        "the column scheme holds words, and numbers are wanted",
        "the study has no column 'run_step'; did you mean 'run_step_s'?",
        "the study has no setting 'steps'",
        "drive_speed_rad_s has more than 8 values, too many to tell apart",
    };
    Text svg;
    text_init(&svg);
    make_store(RUNS);
    Store *store = view();
    for (int i = 0; i < 4; i++) {
        Err err = {0};
        assert_false(study_plot_write(store, &PLOTS[i], NULL, &svg, &err));
        assert_int_equal(err.kind, ERR_USAGE);
        assert_non_null(strstr(err.text, WORDS[i]));
        assert_string_equal(svg.data, "");
    }
    Err err = {0};
    store_close(store, &err);
    text_finish(&svg);
}

#define WRITER_TEST(name) cmocka_unit_test_setup_teardown(name, set_up_out, tear_down_out)

int main(void)
{
    const struct CMUnitTest tests[] = {
        WRITER_TEST(csv_brings_back_every_number),
        WRITER_TEST(an_infinity_is_an_empty_cell_and_null),
        WRITER_TEST(json_lines_bring_back_every_number),
        WRITER_TEST(an_export_never_writes_over_its_store),
        WRITER_TEST(status_counts_outcomes_and_reasons),
        WRITER_TEST(the_summary_has_a_row_a_result),
        WRITER_TEST(the_summary_has_the_main_results),
        WRITER_TEST(a_picture_has_lines_on_a_grid_and_dots_elsewhere),
        WRITER_TEST(a_picture_of_one_column_is_its_distribution),
        WRITER_TEST(what_cannot_be_drawn_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

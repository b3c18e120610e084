// Are counts, reasons, values, quantiles and points of a store those of its rows?
#include "commands/study/study_plot.h"

#include "base/sorted.h"

#include "study_store.h"

static void counts_are_those_of_the_rows(void **state)
{
    (void)state;
    Err err = {0};
    StoreCount count;
    double wall_s = 0.0;
    const Layout layout = study_layout();
    make_store(110);
    for (uint64_t run = 0; run < 110; run++) {
        wall_s += study_record(&layout, run).wall_s;
    }
    Store *store = store_view(path, &err);
    assert_true(store_count(store, &count, &err));
    assert_int_equal(count.run_count, RUNS);
    assert_int_equal(count.rows, 110);
    // 7 and 107 failed, 57 took too long
    assert_int_equal(count.outcomes[RUN_OUTCOME_OK], 107);
    assert_int_equal(count.outcomes[RUN_OUTCOME_FAILED], 2);
    assert_int_equal(count.outcomes[RUN_OUTCOME_TIMED_OUT], 1);
    assert_int_equal(count.outcomes[RUN_OUTCOME_REFUSED] + count.outcomes[RUN_OUTCOME_ENDED], 0);
    // sums of one sign differ by rounding alone
    assert_close(count.wall_s, wall_s, 1e-13);
    store_close(store, &err);
}

// A setting and a result of each run.
static void points_are_those_of_the_rows(void **state)
{
    (void)state;
    Err err = {0};
    StudyPoints points = {0};
    const Layout layout = study_layout();
    make_store(3);
    Store *store = store_view(path, &err);
    assert_true(study_points_read(store, "run_step_s", "steps", NULL, &points, &err));
    assert_int_equal(points.count, 3);
    // by rising step, which rises with the run
    for (uint64_t run = 0; run < 3; run++) {
        const Record record = study_record(&layout, run);
        assert_near(points.points[run].x, record.settings[3].number, 0.0);
        assert_near(points.points[run].y, record.results[23], 0.0);
    }
    study_points_finish(&points);
    store_close(store, &err);
}

static void an_empty_store_counts_nothing(void **state)
{
    (void)state;
    Err err = {0};
    StoreCount count;
    StoreReason reasons[2];
    size_t reason_count = 9;
    StoreSpread spread;
    make_store(0);
    Store *store = store_view(path, &err);
    assert_true(store_count(store, &count, &err));
    assert_int_equal(count.rows + count.outcomes[RUN_OUTCOME_OK], 0);
    assert_near(count.wall_s, 0.0, 0.0);
    assert_true(store_reasons(store, 2, reasons, &reason_count, &err));
    assert_int_equal(reason_count, 0);
    assert_true(store_spread(store, 4, &spread, &err));
    assert_int_equal(spread.count, 0);
    assert_true(isnan(spread.least) && isnan(spread.median) && isnan(spread.most));
    store_close(store, &err);
}

static void reasons_come_with_the_most_frequent_first(void **state)
{
    (void)state;
    Err err = {0};
    StoreReason reasons[3];
    size_t count = 0;
    make_store(110);
    Store *store = store_view(path, &err);
    assert_true(store_reasons(store, 3, reasons, &count, &err));
    assert_int_equal(count, 2);
    assert_int_equal(reasons[0].outcome, RUN_OUTCOME_FAILED);
    assert_string_equal(reasons[0].reason, "a number is not finite at 0.0125 s");
    assert_int_equal(reasons[0].count, 2);
    assert_int_equal(reasons[0].example, 7);
    assert_int_equal(reasons[1].outcome, RUN_OUTCOME_TIMED_OUT);
    assert_int_equal(reasons[1].example, 57);
    assert_true(store_reasons(store, 1, reasons, &count, &err));
    assert_int_equal(count, 1);
    store_close(store, &err);
}

static void columns_are_found_by_name(void **state)
{
    (void)state;
    const Layout layout = study_layout();
    assert_int_equal(store_column(&layout, "scheme"), 2);
    assert_int_equal(store_column(&layout, "coupler_omega_max_rad_s"), 4);
    assert_int_equal(store_column(&layout, "evaluations"), 28);
    assert_int_equal(store_column(&layout, "Scheme"), 29);
}

static void values_come_in_order_and_each_once(void **state)
{
    (void)state;
    Err err = {0};
    Cell values[4];
    size_t count = 0;
    make_store(RUNS);
    Store *store = store_view(path, &err);
    assert_true(store_values(store, 2, 4, values, &count, &err));
    assert_int_equal(count, 2);
    assert_string_equal(values[0].word, "direct/plain/textbook");
    assert_string_equal(values[1].word, "direct/staggered/impulse");
    assert_true(store_values(store, 0, 4, values, &count, &err));
    assert_int_equal(count, 5);
    for (int i = 0; i < 4; i++) {
        assert_near(values[i].number, 10.471975511965978 * (i + 1), 0.0);
    }
    store_close(store, &err);
}

// The numbers of a result over the runs that went well, in order; of all speeds or of one.
static size_t list_values(size_t result, bool is_one_speed, double speed, double values[RUNS])
{
    const Layout layout = study_layout();
    size_t count = 0;
    for (uint64_t run = 0; run < RUNS; run++) {
        const Record record = study_record(&layout, run);
        if (record.outcome == RUN_OUTCOME_OK &&
            (!is_one_speed || record.settings[0].number == speed)) {
            values[count++] = record.results[result];
        }
    }
    sorted_make(values, count);
    return count;
}

// Definition 7 of Hyndman and Fan, as they write it: (1 - g) x[j] + g x[j + 1] with j + g =
// (n - 1) p + 1, numbered from 1.
static double interpolated(const double *values, size_t count, double p)
{
    const double at = ((double)count - 1.0) * p + 1.0;
    const size_t j = (size_t)floor(at);
    const double g = at - floor(at);
    return j < count ? (1.0 - g) * values[j - 1] + g * values[j] : values[count - 1];
}

static void expect_spread(const StoreSpread *spread, const double *values, size_t count)
{
    assert_int_equal(spread->count, count);
    assert_near(spread->least, values[0], 0.0);
    const double rounding = 1e-12 * fabs(values[count - 1]);
    assert_near(spread->low, interpolated(values, count, 0.05), rounding);
    assert_near(spread->median, interpolated(values, count, 0.5), rounding);
    assert_near(spread->high, interpolated(values, count, 0.95), rounding);
    assert_near(spread->most, values[count - 1], 0.0);
}

static void quantiles_lie_between_the_ranks_beside_them(void **state)
{
    (void)state;
    Err err = {0};
    double values[RUNS];
    StoreSpread spread;
    make_store(RUNS);
    Store *store = store_view(path, &err);
    // a real result, then a whole one
    for (size_t result = 3; result < 25; result += 20) {
        assert_true(store_spread(store, 4 + result, &spread, &err));
        expect_spread(&spread, values, list_values(result, false, 0.0, values));
    }
    store_close(store, &err);
}

static void quantiles_of_many_columns_are_those_of_each(void **state)
{
    (void)state;
    enum { COLUMNS = 20 };
    Err err = {0};
    StoreSpread all[COLUMNS];
    make_store(RUNS);
    Store *store = store_view(path, &err);
    assert_true(store_spreads(store, 4 + 3, COLUMNS, all, &err));
    size_t different = 0; // from the first: the control that columns are not mixed up
    for (size_t i = 0; i < COLUMNS; i++) {
        StoreSpread own;
        assert_true(store_spread(store, 4 + 3 + i, &own, &err));
        assert_memory_equal(&all[i], &own, sizeof own);
        different += all[i].median != all[0].median ? 1 : 0;
    }
    assert_true(different > 0);
    store_close(store, &err);
}

#define STORE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(counts_are_those_of_the_rows),
        STORE_TEST(points_are_those_of_the_rows),
        STORE_TEST(an_empty_store_counts_nothing),
        STORE_TEST(reasons_come_with_the_most_frequent_first),
        cmocka_unit_test(columns_are_found_by_name),
        STORE_TEST(values_come_in_order_and_each_once),
        STORE_TEST(quantiles_lie_between_the_ranks_beside_them),
        STORE_TEST(quantiles_of_many_columns_are_those_of_each),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

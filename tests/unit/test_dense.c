// Are systems solved, small and banded ones, and is a dependent row noticed?
#include "base/banded.h"
#include "base/dense.h"
#include "base/lcg.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

static void a_system_that_needs_a_swap_is_solved(void **state)
{
    (void)state;
    // the first pivot is zero
    double a[9] = {0.0, 2.0, 1.0, 1.0, 1.0, 1.0, 2.0, 0.0, -1.0};
    double b[3] = {7.0, 6.0, -1.0};
    assert_true(dense_solve(3, a, b));
    assert_true(fabs(b[0] - 1.0) <= 1e-14);
    assert_true(fabs(b[1] - 2.0) <= 1e-14);
    assert_true(fabs(b[2] - 3.0) <= 1e-14);
}

static void the_answer_fits_the_system(void **state)
{
    (void)state;
    enum { N = 12 };
    double a[N * N];
    double kept[N * N];
    double x[N];
    for (int i = 0; i < N * N; i++) {
        // numbers without a pattern, between -1 and 1
        a[i] = sin(1.7 * i * i + 0.3);
        kept[i] = a[i];
    }
    for (int i = 0; i < N; i++) {
        x[i] = cos(i);
    }
    assert_true(dense_solve(N, a, x));
    for (int i = 0; i < N; i++) {
        double sum = 0.0;
        for (int j = 0; j < N; j++) {
            sum += kept[i * N + j] * x[j];
        }
        assert_true(fabs(sum - cos(i)) <= 1e-12);
    }
}

static void a_singular_system_is_refused(void **state)
{
    (void)state;
    double a[4] = {1.0, 2.0, 2.0, 4.0};
    double b[2] = {1.0, 2.0};
    assert_false(dense_solve(2, a, b));
    double zero[4] = {0.0};
    assert_false(dense_solve(2, zero, b));
}

// Masses, kg, and inertias, kg m^2, stand in one matrix: what is small for its units is not
// singular.
static void unknowns_of_other_units_are_judged_by_themselves(void **state)
{
    (void)state;
    double a[9] = {1e5, 0.0, 1e-3, 0.0, 1e-11, 0.0, 1e-3, 0.0, 2e-11};
    double b[3] = {1e5 + 1e-3, 3e-11, 1e-3 + 2e-11};
    assert_true(dense_solve(3, a, b));
    assert_true(fabs(b[0] - 1.0) <= 1e-14);
    assert_true(fabs(b[1] - 3.0) <= 1e-14);
    // 1e-11 is left of 2e-11 in the last column: one bit of b's third number is 1e-8 of the answer
    assert_true(fabs(b[2] - 1.0) <= 1e-7);
    double dependent[4] = {1.0, 1e-20, 1.0, 1e-20};
    assert_false(dense_solve(2, dependent, b));
}

static void a_matrix_that_is_not_finite_is_refused(void **state)
{
    (void)state;
    double a[4] = {NAN, 2.0, 2.0, NAN};
    double b[2] = {1.0, 2.0};
    assert_false(dense_solve(2, a, b));
}

static void the_rank_counts_independent_rows(void **state)
{
    (void)state;
    double full[6] = {1.0, 0.0, 2.0, 0.0, 3.0, 1.0};
    assert_int_equal(dense_rank(2, 3, full, 1e-9), 2);
    // the third row is the sum of the others
    double dependent[9] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 5.0, 7.0, 9.0};
    assert_int_equal(dense_rank(3, 3, dependent, 1e-9), 2);
    double tall[6] = {1.0, 0.0, 0.0, 1.0, 1.0, 1.0};
    assert_int_equal(dense_rank(3, 2, tall, 1e-9), 2);
    double zero[4] = {0.0};
    assert_int_equal(dense_rank(2, 2, zero, 1e-9), 0);
}

static void a_row_that_differs_by_less_than_the_tolerance_does_not_count(void **state)
{
    (void)state;
    double near[4] = {1.0, 2.0, 1.0, 2.0 + 1e-12};
    assert_int_equal(dense_rank(2, 2, near, 1e-9), 1);
    // the control: well above the tolerance it does count
    double apart[4] = {1.0, 2.0, 1.0, 2.0 + 1e-6};
    assert_int_equal(dense_rank(2, 2, apart, 1e-9), 2);
}

static void a_factored_matrix_serves_many_right_hand_sides(void **state)
{
    (void)state;
    const double kept[9] = {0.0, 2.0, 1.0, 1.0, 1.0, 1.0, 2.0, 0.0, -1.0};
    double a[9];
    size_t pivots[3];
    for (int i = 0; i < 9; i++) {
        a[i] = kept[i];
    }
    assert_true(dense_factor(3, a, pivots));
    for (int k = 0; k < 2; k++) {
        const double x[3] = {1.0 - k, 2.0 + k, 3.0 * k - 1.0};
        double b[3] = {0.0, 0.0, 0.0};
        for (int i = 0; i < 9; i++) {
            b[i / 3] += kept[i] * x[i % 3];
        }
        dense_substitute(3, a, pivots, b);
        for (int i = 0; i < 3; i++) {
            assert_true(fabs(b[i] - x[i]) <= 1e-14);
        }
    }
}

// Random rows that need exchanges, with zeros as a linkage's have them.
static void a_split_matrix_solves_as_a_whole_one_does_to_the_last_bit(void **state)
{
    (void)state;
    enum { N = 9, ROUNDS = 200, SIDES = 3 };
    uint64_t seed = 5;
    for (int round = 0; round < ROUNDS; round++) {
        double a[N * N], b[SIDES][N], split[N * N];
        size_t pivots[N];
        for (int i = 0; i < N * N; i++) {
            const double draw = lcg_draw(&seed);
            a[i] = lcg_draw(&seed) < 0.0 ? 0.0 : draw;
        }
        for (int i = 0; i < SIDES * N; i++) {
            b[i / N][i % N] = lcg_draw(&seed);
        }
        memcpy(split, a, sizeof split);
        const bool is_regular = dense_split(N, split, pivots);
        for (int side = 0; side < SIDES; side++) {
            double whole[N * N], x[N];
            memcpy(whole, a, sizeof whole);
            memcpy(x, b[side], sizeof x);
            assert_int_equal(dense_solve(N, whole, x), is_regular);
            if (is_regular) {
                dense_solve_split(N, split, pivots, b[side]);
                assert_memory_equal(b[side], x, sizeof x);
            }
        }
    }
    // the control: rows that stay where they are give another answer
    double a[] = {1.0, 2.0, 3.0, 4.0}, b[] = {1.0, 2.0}, straight[] = {1.0, 2.0};
    size_t pivots[2];
    assert_true(dense_split(2, a, pivots));
    dense_solve_split(2, a, pivots, b);
    dense_solve_split(2, a, (const size_t[]){0, 1}, straight);
    assert_true(fabs(b[0]) < 1e-15);
    assert_true(fabs(b[1] - 0.5) < 1e-15);
    assert_true(fabs(straight[0] - b[0]) > 0.1);
}

static void a_column_of_zeros_is_not_factored(void **state)
{
    (void)state;
    double a[4] = {1.0, 0.0, 2.0, 0.0};
    size_t pivots[2];
    assert_false(dense_factor(2, a, pivots));
}

// Small diagonals, so that rows are exchanged.
static double banded_entry_of(uint64_t *seed, size_t row, size_t column)
{
    const double draw = lcg_draw(seed);
    return row == column ? 0.01 * draw : draw;
}

static void a_banded_system_is_solved_as_a_dense_one(void **state)
{
    (void)state;
    enum { N = 30, REACH = 3 };
    Banded banded = {.count = 0};
    for (unsigned number = 0; number < 20; number++) {
        // the same matrix is shaped anew, banded and dense
        const size_t reach = number % 2 == 0 ? REACH : N;
        uint64_t seed = lcg_stirred(number);
        double a[N * N] = {0.0};
        double b[N];
        double x[N];
        banded_shape(&banded, N, reach);
        for (size_t i = 0; i < N; i++) {
            for (size_t k = banded_first(&banded, i); k < banded_end(&banded, i); k++) {
                a[i * N + k] = *banded_entry(&banded, i, k) = banded_entry_of(&seed, i, k);
            }
            b[i] = lcg_draw(&seed);
        }
        memcpy(x, b, sizeof x);
        assert_true(dense_solve(N, a, b));
        assert_true(banded_factor(&banded));
        banded_substitute(&banded, x);
        for (size_t i = 0; i < N; i++) {
            assert_true(fabs(x[i] - b[i]) <= 1e-9 * (1.0 + fabs(b[i])));
        }
    }
    banded_shape(&banded, N, REACH);
    assert_false(banded_factor(&banded));
    banded_finish(&banded);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_system_that_needs_a_swap_is_solved),
        cmocka_unit_test(the_answer_fits_the_system),
        cmocka_unit_test(a_factored_matrix_serves_many_right_hand_sides),
        cmocka_unit_test(a_split_matrix_solves_as_a_whole_one_does_to_the_last_bit),
        cmocka_unit_test(a_column_of_zeros_is_not_factored),
        cmocka_unit_test(a_banded_system_is_solved_as_a_dense_one),
        cmocka_unit_test(a_singular_system_is_refused),
        cmocka_unit_test(unknowns_of_other_units_are_judged_by_themselves),
        cmocka_unit_test(a_matrix_that_is_not_finite_is_refused),
        cmocka_unit_test(the_rank_counts_independent_rows),
        cmocka_unit_test(a_row_that_differs_by_less_than_the_tolerance_does_not_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

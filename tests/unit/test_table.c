// Are tables set out so that numbers of any length stand under one another?
#include "write/table.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static void expect_table(const Table *table, const char *expected)
{
    Text text;
    text_init(&text);
    table_write(table, &text);
    assert_string_equal(text.data, expected);
    text_finish(&text);
}

static void numbers_stand_to_the_right_and_words_to_the_left(void **state)
{
    (void)state;
    Table *table = table_create(2);
    table_head(table, 0, "body", "", TABLE_LEFT);
    table_head(table, 1, "omega max", "rad/s", TABLE_RIGHT);
    table_cell(table, "coupler");
    table_cell(table, "%.6g", 42.2008);
    table_cell(table, "a");
    table_cell(table, "%.6g", -7.0);
    expect_table(table, "  body     omega max\n"
                        "               rad/s\n"
                        "  ------------------\n"
                        "  coupler    42.2008\n"
                        "  a               -7\n");
    table_destroy(table);
}

static void zero_has_no_sign(void **state)
{
    (void)state;
    Table *table = table_create(1);
    table_head(table, 0, "x", "", TABLE_RIGHT);
    table_cell(table, "%.4g", -0.0);
    table_cell(table, "%.2f", -0.001);
    // the control: what is not zero, or no number
    table_cell(table, "%.2f", -0.01);
    table_cell(table, "-");
    expect_table(table, "      x\n  -----\n      0\n   0.00\n  -0.01\n      -\n");
    table_destroy(table);
}

static void a_line_without_units_is_left_out(void **state)
{
    (void)state;
    Table *table = table_create(1);
    table_head(table, 0, "name", "", TABLE_LEFT);
    table_cell(table, "x");
    expect_table(table, "  name\n  ----\n  x\n");
    table_destroy(table);
}

static void a_table_without_heads_has_rows_alone(void **state)
{
    (void)state;
    Table *table = table_create(2);
    table_cell(table, "a");
    table_cell(table, "b");
    expect_table(table, "  a  b\n");
    table_destroy(table);
}

static void no_line_ends_in_spaces(void **state)
{
    (void)state;
    Table *table = table_create(3);
    table_head(table, 0, "a", "", TABLE_LEFT);
    table_head(table, 1, "b", "", TABLE_RIGHT);
    table_head(table, 2, "long one", "", TABLE_LEFT);
    table_cell(table, "1");
    table_cell(table, "%s", "");
    table_cell(table, "%s", "");
    table_cell(table, "%s", "");
    table_cell(table, "%s", "");
    table_cell(table, "z");
    expect_table(table, "  a  b  long one\n"
                        "  --------------\n"
                        "  1\n"
                        "        z\n");
    table_destroy(table);
}

static void a_rule_stands_below_the_rows_filled_so_far(void **state)
{
    (void)state;
    Table *table = table_create(1);
    table_cell(table, "first");
    table_rule(table);
    table_cell(table, "last");
    table_rule(table);
    expect_table(table, "  first\n  -----\n  last\n  -----\n");
    table_destroy(table);
}

static void a_character_of_two_bytes_is_one_wide(void **state)
{
    (void)state;
    Table *table = table_create(2);
    table_cell(table, "\xc2\xb5m");
    table_cell(table, "x");
    table_cell(table, "mm");
    table_cell(table, "y");
    expect_table(table, "  \xc2\xb5m  x\n  mm  y\n");
    table_destroy(table);
}

static void a_head_can_be_replaced(void **state)
{
    (void)state;
    Table *table = table_create(1);
    table_head(table, 0, "old", "s", TABLE_LEFT);
    table_head(table, 0, "new", "ms", TABLE_LEFT);
    table_cell(table, "1");
    expect_table(table, "  new\n  ms\n  ---\n  1\n");
    table_destroy(table);
}

static void many_rows_and_rules_are_kept(void **state)
{
    (void)state;
    Table *table = table_create(2);
    for (int i = 0; i < 500; i++) {
        table_cell(table, "%d", i);
        table_cell(table, "row");
        table_rule(table);
    }
    Text text;
    text_init(&text);
    table_write(table, &text);
    size_t lines = 0;
    for (const char *c = text.data; *c != '\0'; c++) {
        lines += *c == '\n' ? 1 : 0;
    }
    assert_int_equal(lines, 1000);
    text_finish(&text);
    table_destroy(table);
}

// Key, two numbers and a detail: 2 + 4 + 2 + 6 + 2 + 6 + 2 + 6 = 30 characters.
static Table *four_columns(void)
{
    Table *table = table_create(4);
    table_head(table, 0, "name", "", TABLE_LEFT);
    table_head(table, 1, "first!", "", TABLE_RIGHT);
    table_head(table, 2, "detail", "", TABLE_RIGHT | TABLE_DETAIL);
    table_head(table, 3, "minor!", "", TABLE_RIGHT | TABLE_MINOR);
    table_cell(table, "a");
    table_cell(table, "1");
    table_cell(table, "2");
    table_cell(table, "3");
    return table;
}

static void a_table_that_fits_is_left_alone(void **state)
{
    (void)state;
    Table *table = four_columns();
    table_fit(table, 30);
    expect_table(table, "  name  first!  detail  minor!\n"
                        "  ----------------------------\n"
                        "  a          1       2       3\n");
    table_destroy(table);
}

static void the_least_important_columns_go_first_and_are_named(void **state)
{
    (void)state;
    Table *table = four_columns();
    table_fit(table, 29);
    expect_table(table, "  name  first!  minor!\n"
                        "  --------------------\n"
                        "  a          1       3\n"
                        "  Columns left out, --wide shows them: detail.\n");
    table_fit(table, 21);
    expect_table(table, "  name  first!\n"
                        "  ------------\n"
                        "  a          1\n"
                        "  Columns left out, --wide shows them: detail, minor!.\n");
    table_destroy(table);
}

static void what_is_still_too_wide_is_written_in_parts_with_all_columns(void **state)
{
    (void)state;
    Table *table = table_create(4);
    table_head(table, 0, "name", "", TABLE_LEFT);
    table_head(table, 1, "one...", "", TABLE_RIGHT);
    table_head(table, 2, "two...", "", TABLE_RIGHT);
    table_head(table, 3, "detail", "", TABLE_RIGHT | TABLE_DETAIL);
    table_cell(table, "a");
    table_cell(table, "1");
    table_cell(table, "2");
    table_cell(table, "3");
    table_rule(table);
    table_fit(table, 15);
    expect_table(table, "  name  one...\n"
                        "  ------------\n"
                        "  a          1\n"
                        "  ------------\n"
                        "\n"
                        "  name  two...\n"
                        "  ------------\n"
                        "  a          2\n"
                        "  ------------\n"
                        "\n"
                        "  name  detail\n"
                        "  ------------\n"
                        "  a          3\n"
                        "  ------------\n");
    table_destroy(table);
}

static void one_wide_column_does_not_part_the_narrow_ones(void **state)
{
    (void)state;
    Table *table = table_create(5);
    table_head(table, 0, "name", "", TABLE_LEFT);
    table_head(table, 1, "one", "", TABLE_RIGHT);
    table_head(table, 2, "very wide", "", TABLE_RIGHT);
    table_head(table, 3, "two", "", TABLE_RIGHT);
    table_head(table, 4, "three", "", TABLE_RIGHT);
    for (int i = 0; i < 5; i++) {
        table_cell(table, "%d", i);
    }
    table_fit(table, 18);
    expect_table(table, "  name  one\n"
                        "  ---------\n"
                        "  0       1\n"
                        "\n"
                        "  name  very wide\n"
                        "  ---------------\n"
                        "  0             2\n"
                        "\n"
                        "  name  two  three\n"
                        "  ----------------\n"
                        "  0       3      4\n");
    table_destroy(table);
}

static void a_key_column_stands_in_every_part(void **state)
{
    (void)state;
    Table *table = table_create(4);
    for (int i = 0; i < 4; i++) {
        table_cell(table, "%d%d%d%d%d%d", i, i, i, i, i, i);
    }
    table_head(table, 1, "key", "", TABLE_RIGHT | TABLE_KEY);
    table_fit(table, 24);
    Text text;
    text_init(&text);
    table_write(table, &text);
    const char *first = strstr(text.data, "000000  111111  222222\n");
    assert_non_null(first);
    assert_non_null(strstr(first, "000000  111111  333333\n"));
    text_finish(&text);
    table_destroy(table);
}

static void words_are_broken_into_lines_of_their_own_column(void **state)
{
    (void)state;
    Table *table = table_create(2);
    table_cell(table, "a");
    table_cell(table, "the pin is too deep in the wall");
    table_head(table, 0, "n", "", TABLE_LEFT);
    table_head(table, 1, "why", "", TABLE_WRAP);
    table_fit(table, 26);
    expect_table(table, "  n  why\n"
                        "  ------------------------\n"
                        "  a  the pin is too deep\n"
                        "     in the wall\n");
    // the control: with room they stay in one
    table_fit(table, 80);
    expect_table(table, "  n  why\n"
                        "  ----------------------------------\n"
                        "  a  the pin is too deep in the wall\n");
    table_destroy(table);
}

static void destroying_nothing_does_nothing(void **state)
{
    (void)state;
    table_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_stand_to_the_right_and_words_to_the_left),
        cmocka_unit_test(zero_has_no_sign),
        cmocka_unit_test(a_line_without_units_is_left_out),
        cmocka_unit_test(a_table_without_heads_has_rows_alone),
        cmocka_unit_test(no_line_ends_in_spaces),
        cmocka_unit_test(a_rule_stands_below_the_rows_filled_so_far),
        cmocka_unit_test(a_character_of_two_bytes_is_one_wide),
        cmocka_unit_test(a_head_can_be_replaced),
        cmocka_unit_test(many_rows_and_rules_are_kept),
        cmocka_unit_test(a_table_that_fits_is_left_alone),
        cmocka_unit_test(the_least_important_columns_go_first_and_are_named),
        cmocka_unit_test(what_is_still_too_wide_is_written_in_parts_with_all_columns),
        cmocka_unit_test(one_wide_column_does_not_part_the_narrow_ones),
        cmocka_unit_test(a_key_column_stands_in_every_part),
        cmocka_unit_test(words_are_broken_into_lines_of_their_own_column),
        cmocka_unit_test(destroying_nothing_does_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

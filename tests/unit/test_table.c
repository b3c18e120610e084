// Are tables set out so that numbers of any length stand under one another?
#include "base/table.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

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

static void destroying_nothing_does_nothing(void **state)
{
    (void)state;
    table_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_stand_to_the_right_and_words_to_the_left),
        cmocka_unit_test(a_line_without_units_is_left_out),
        cmocka_unit_test(a_table_without_heads_has_rows_alone),
        cmocka_unit_test(no_line_ends_in_spaces),
        cmocka_unit_test(a_rule_stands_below_the_rows_filled_so_far),
        cmocka_unit_test(a_character_of_two_bytes_is_one_wide),
        cmocka_unit_test(a_head_can_be_replaced),
        cmocka_unit_test(many_rows_and_rules_are_kept),
        cmocka_unit_test(destroying_nothing_does_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Is an error told once, and is the first one kept?
#include "base/err.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

static void the_first_error_wins(void **state)
{
    (void)state;
    Err err = {0};
    assert_false(err_set(&err, ERR_FILE, "cannot read %s", "a.yaml"));
    assert_false(err_set(&err, ERR_CASE, "something else"));
    assert_int_equal(err.kind, ERR_FILE);
    assert_string_equal(err.text, "cannot read a.yaml");
}

static void a_prefix_stands_in_front(void **state)
{
    (void)state;
    Err err = {0};
    err_set(&err, ERR_SOLVER, "not finite");
    err_prefix(&err, "ode");
    assert_string_equal(err.text, "ode: not finite");
    assert_int_equal(err.kind, ERR_SOLVER);
}

static void a_prefix_without_an_error_does_nothing(void **state)
{
    (void)state;
    Err err = {0};
    err_prefix(&err, "ode");
    assert_int_equal(err.kind, ERR_NONE);
    assert_string_equal(err.text, "");
}

static void a_text_too_long_ends_behind_a_whole_word(void **state)
{
    (void)state;
    char long_text[2 * ERR_TEXT_SIZE];
    memset(long_text, 'x', sizeof long_text - 1);
    long_text[sizeof long_text - 1] = '\0';
    Err err = {0};
    err_set(&err, ERR_CASE, "%s", long_text);
    assert_int_equal(strlen(err.text), ERR_TEXT_SIZE - 1);
    err_prefix(&err, "a");
    assert_int_equal(strlen(err.text), ERR_TEXT_SIZE - 1);
    assert_memory_equal(err.text, "a: xxx", 6);
    err_prefix(&err, long_text);
    assert_int_equal(strlen(err.text), ERR_TEXT_SIZE - 1);
    Err words = {0};
    for (size_t i = 0; i < sizeof long_text - 1; i++) {
        long_text[i] = i % 5 == 4 ? ' ' : 'w';
    }
    err_set(&words, ERR_CASE, "%s", long_text);
    assert_true(strlen(words.text) > ERR_TEXT_SIZE - 10);
    assert_string_equal(words.text + strlen(words.text) - 9, " wwww ...");
}

static void kinds_are_the_exit_statuses_that_are_documented(void **state)
{
    (void)state;
    assert_int_equal(ERR_NONE, 0);
    assert_int_equal(ERR_DIFFERS, 1);
    assert_int_equal(ERR_USAGE, 2);
    assert_int_equal(ERR_CASE, 3);
    assert_int_equal(ERR_SOLVER, 4);
    assert_int_equal(ERR_FILE, 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_error_wins),
        cmocka_unit_test(a_prefix_stands_in_front),
        cmocka_unit_test(a_prefix_without_an_error_does_nothing),
        cmocka_unit_test(a_text_too_long_ends_behind_a_whole_word),
        cmocka_unit_test(kinds_are_the_exit_statuses_that_are_documented),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

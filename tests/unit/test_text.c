// Is text put together whole, and is the word that was meant found?
#include "base/text.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

static void text_grows_as_it_must(void **state)
{
    (void)state;
    Text text;
    text_init(&text);
    for (int i = 0; i < 1000; i++) {
        text_append(&text, "%04d,", i);
    }
    assert_int_equal(text.length, 5000);
    assert_int_equal(strlen(text.data), 5000);
    assert_memory_equal(text.data + 4995, "0999,", 5);
    text_finish(&text);
}

static void a_new_text_is_empty_and_readable(void **state)
{
    (void)state;
    Text text;
    text_init(&text);
    assert_string_equal(text.data, "");
    text_finish(&text);
    assert_null(text.data);
    text_finish(&text);
    text_finish(NULL);
}

static void a_copy_is_cut_to_its_buffer(void **state)
{
    (void)state;
    char name[6];
    text_copy(name, sizeof name, "coupler");
    assert_string_equal(name, "coupl");
    text_copy(name, sizeof name, "pin");
    assert_string_equal(name, "pin");
}

static void the_distance_counts_slips_of_the_finger(void **state)
{
    (void)state;
    assert_int_equal(text_distance("step", "step"), 0);
    assert_int_equal(text_distance("step", "stp"), 1);
    assert_int_equal(text_distance("stp", "step"), 1);
    assert_int_equal(text_distance("step", "stop"), 1);
    assert_int_equal(text_distance("step", "setp"), 1);
    assert_int_equal(text_distance("", "step"), 4);
    assert_int_equal(text_distance("kitten", "sitting"), 3);
}

static void words_of_any_length_have_a_distance(void **state)
{
    (void)state;
    char long_word[300];
    memset(long_word, 'a', sizeof long_word - 1);
    long_word[sizeof long_word - 1] = '\0';
    assert_int_equal(text_distance(long_word, long_word), 0);
    assert_true(text_distance(long_word, "b") > 0);
}

static void the_nearest_word_is_found_and_a_far_one_is_not(void **state)
{
    (void)state;
    const char *const commands[] = {"run", "paper", "help"};
    assert_string_equal(text_nearest("rnu", commands, 3), "run");
    assert_string_equal(text_nearest("papre", commands, 3), "paper");
    assert_string_equal(text_nearest("hlep", commands, 3), "help");
    assert_null(text_nearest("simulate", commands, 3));
    assert_null(text_nearest("xy", commands, 3));
    assert_null(text_nearest("run", commands, 0));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_grows_as_it_must),
        cmocka_unit_test(a_new_text_is_empty_and_readable),
        cmocka_unit_test(a_copy_is_cut_to_its_buffer),
        cmocka_unit_test(the_distance_counts_slips_of_the_finger),
        cmocka_unit_test(words_of_any_length_have_a_distance),
        cmocka_unit_test(the_nearest_word_is_found_and_a_far_one_is_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

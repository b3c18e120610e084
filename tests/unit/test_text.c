// Is text put together whole, and is the word that was meant found?
#include "base/text.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
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
    assert_string_equal(text_nearest("rn", commands, 3), "run");
    assert_null(text_nearest("simulate", commands, 3));
    assert_null(text_nearest("xy", commands, 3));
    assert_null(text_nearest("run", commands, 0));
}

static void expect_folded(const char *source, size_t width, const char *expected)
{
    Text text;
    text_init(&text);
    text_append(&text, "%s", source);
    text_fold(&text, width);
    assert_string_equal(text.data, expected);
    text_finish(&text);
}

static void sentences_are_broken_between_words(void **state)
{
    (void)state;
    expect_folded("  one two three four\n", 11, "  one two\n  three\n  four\n");
    expect_folded("  one two three four\n", 20, "  one two three four\n");
    expect_folded("  one two three four\n", 0, "  one two three four\n");
    // without an end, as it was
    expect_folded("one two", 4, "one\ntwo");
    // a word that is too long stays whole
    expect_folded("/a/very/long/path is not there\n", 12, "/a/very/long/path\nis not there\n");
}

static void what_has_a_name_is_broken_under_its_words(void **state)
{
    (void)state;
    expect_folded("  truth   the reference of this run, sure to 1e-9 of omega\n", 32,
                  "  truth   the reference of this\n"
                  "          run, sure to 1e-9 of\n"
                  "          omega\n");
}

static void a_number_stays_with_its_unit(void **state)
{
    (void)state;
    expect_folded("a clearance of 14.5 um there\n", 20, "a clearance of\n14.5 um there\n");
}

static void tables_code_and_colours_are_no_words(void **state)
{
    (void)state;
    static const char TABLE[] = "  name  number  what\n";
    static const char CODE[] = "    double force = depth / 3.0;\n";
    expect_folded(TABLE, 12, TABLE);
    expect_folded(CODE, 12, CODE);
    expect_folded("\x1b[1mone two\x1b[0m\n", 7, "\x1b[1mone two\x1b[0m\n");
    expect_folded("\x1b[1mone two\x1b[0m\n", 6, "\x1b[1mone\ntwo\x1b[0m\n");
}

// The fewest of 15 to 17 digits that read back, found by trying each.
static void expect_number(double value)
{
    char words[40];
    Text text;
    text_init(&text);
    text_append_number(&text, value);
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(words, sizeof words, "%.*g", digits, value);
        if (strtod(words, NULL) == value) {
            break;
        }
    }
    if (strcmp(text.data, words) != 0) {
        fail_msg("%a is %s and not %s", value, words, text.data);
    }
    text_finish(&text);
}

static void a_number_has_the_fewest_digits_that_read_back(void **state)
{
    (void)state;
    static const double HARD[] = {
        0.0,     -0.0,    1.0,      0.1,    100000.0, 1e15,
        1e16,    1e17,    5e-324,   1e22,   1e23,     9007199254740993.0,
        DBL_MAX, DBL_MIN, 0x1p-537, 0x1p60, 1e-5,     123456789012345678.0};
    for (size_t i = 0; i < sizeof HARD / sizeof *HARD; i++) {
        for (int k = 0; k < 2; k++) {
            const double value = k == 0 ? HARD[i] : -HARD[i];
            expect_number(value);
            expect_number(nextafter(value, INFINITY));
            expect_number(nextafter(value, -INFINITY) > -DBL_MAX ? nextafter(value, -INFINITY) : 0);
        }
    }
    // any bits, and decimals of 14 to 17 digits of any size
    uint64_t seed = 1;
    for (int i = 0; i < 30000; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        const uint64_t bits = seed ^ (seed >> 29);
        double value;
        memcpy(&value, &bits, sizeof value);
        char words[48];
        snprintf(words, sizeof words, "%" PRIu64 "e%d", bits % 100000000000000000u,
                 (int)(bits >> 57) - 64);
        expect_number(isfinite(value) ? value : 1.5);
        expect_number(strtod(words, NULL));
        words[15] = 'e';
        expect_number(isfinite(strtod(words, NULL)) ? strtod(words, NULL) : 2.5);
    }
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
        cmocka_unit_test(sentences_are_broken_between_words),
        cmocka_unit_test(what_has_a_name_is_broken_under_its_words),
        cmocka_unit_test(a_number_stays_with_its_unit),
        cmocka_unit_test(tables_code_and_colours_are_no_words),
        cmocka_unit_test(a_number_has_the_fewest_digits_that_read_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

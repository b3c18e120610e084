// Is everything that a terminal would obey or hide shown as an escape, and all else as it is?
#include "base/err.h"
#include "base/printable.h"

#include "close.h"

#include <stdlib.h>
#include <string.h>

static void check_copy(const char *text, bool keeps_lines, const char *shown)
{
    char *copy = printable_copy(text, keeps_lines);
    assert_string_equal(copy, shown);
    assert_true(printable_is_shown(text) == (strcmp(text, shown) == 0));
    // what is shown is shown as it is
    char *again = printable_copy(copy, keeps_lines);
    assert_string_equal(again, copy);
    free(again);
    free(copy);
}

static void words_of_any_language_stay(void **state)
{
    (void)state;
    static const char *const WORDS[] = {
        "",
        "a b.yaml",
        "C:\\x",
        "Gelenk Größe 14,5 µm",
        "連桿",
        "שלום",
        "😀",
        "e\u0301",
        ("a\xc2\xa0"
         "b"),
    };
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++) {
        check_copy(WORDS[i], false, WORDS[i]);
    }
}

static void what_is_obeyed_or_hidden_is_escaped(void **state)
{
    (void)state;
    check_copy("a\nb\tc\rd", false, "a\\nb\\tc\\rd");
    check_copy("\x1b[31mred\x07\x7f", false, "\\x1b[31mred\\x07\\x7f");
    check_copy("\xc2\x85\xc2\x9b"
               "2J",
               false, "\\u0085\\u009b2J");
    check_copy("x\u202egpj.exe\u202c", false, "x\\u202egpj.exe\\u202c");
    check_copy("\u200e\u200f\u061c\u2066\u2069", false, "\\u200e\\u200f\\u061c\\u2066\\u2069");
    check_copy("a\u2028b\u2029c\ufeff\u200b\u00ad", false,
               "a\\u2028b\\u2029c\\ufeff\\u200b\\u00ad");
    check_copy("\U000e0041\uffff", false, "\\U000e0041\\uffff");
}

static void bytes_that_are_no_text_are_escaped(void **state)
{
    (void)state;
    check_copy("caf\xe9.yaml", false, "caf\\xe9.yaml");
    check_copy("\xff\xfe\x80", false, "\\xff\\xfe\\x80");
    check_copy("\xc0\xaf\xed\xa0\x80\xf4\x90\x80\x80", false,
               "\\xc0\\xaf\\xed\\xa0\\x80\\xf4\\x90\\x80\\x80");
    check_copy("\xe2\x82", false, "\\xe2\\x82");
}

static void line_breaks_stay_where_they_are_asked_for(void **state)
{
    (void)state;
    char *copy = printable_copy("a\n\x1b\nb\r\n", true);
    assert_string_equal(copy, "a\n\\x1b\nb\\r\n");
    free(copy);
}

static void an_error_keeps_its_own_lines_and_shows_those_of_its_arguments(void **state)
{
    (void)state;
    Err err = {0};
    err_set(&err, ERR_FILE, "%s: is none\nallowed: %s", "a\nb\r\x1b]0;x\x07", "c\nd");
    assert_string_equal(err.text, "a\\nb\\r\\x1b]0;x\\x07: is none\nallowed: c\\nd");
    err_prefix(&err, "e\nf");
    assert_string_equal(err.text, "e\\nf: a\\nb\\r\\x1b]0;x\\x07: is none\nallowed: c\\nd");
    Err other = {0};
    err_set_lines(&other, err.kind, err.text);
    assert_string_equal(other.text, err.text);
}

static void a_value_that_a_message_cuts_leaves_no_half_of_a_character(void **state)
{
    (void)state;
    Err err = {0};
    err_set(&err, ERR_CASE, "'%.4s' is no length", "14,\u00b5m");
    assert_string_equal(err.text, "'14,?' is no length");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_of_any_language_stay),
        cmocka_unit_test(what_is_obeyed_or_hidden_is_escaped),
        cmocka_unit_test(bytes_that_are_no_text_are_escaped),
        cmocka_unit_test(line_breaks_stay_where_they_are_asked_for),
        cmocka_unit_test(an_error_keeps_its_own_lines_and_shows_those_of_its_arguments),
        cmocka_unit_test(a_value_that_a_message_cuts_leaves_no_half_of_a_character),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Do messages point where they should?
#include "casefile/source.h"

#include "close.h"

#include <string.h>

static Err point_at(const char *text, size_t start, size_t end)
{
    const Source source = {.name = "x.yaml", .text = text, .size = strlen(text)};
    Err err = {0};
    assert_false(source_error(&source, (Span){start, end}, NULL, &err, "here"));
    assert_int_equal(err.kind, ERR_CASE);
    return err;
}

static void the_caret_stands_below_its_character(void **state)
{
    (void)state;
    assert_string_equal(point_at("a\nbcd: e\n", 7, 8).text,
                        "x.yaml:2:6: here\n    bcd: e\n         ^");
    assert_string_equal(point_at("a\nbcd: e\n", 2, 5).text,
                        "x.yaml:2:1: here\n    bcd: e\n    ^~~");
    // the tail ends with the line
    assert_string_equal(point_at("ab\ncd", 1, 9).text, "x.yaml:1:2: here\n    ab\n     ^");
}

static void every_kind_of_line_break_counts_once(void **state)
{
    (void)state;
    assert_string_equal(point_at("a\r\nb\r\nc", 6, 7).text, "x.yaml:3:1: here\n    c\n    ^");
    assert_string_equal(point_at("a\rb\rc", 4, 5).text, "x.yaml:3:1: here\n    c\n    ^");
    const Source source = {.name = "x", .text = "a\r\nb", .size = 4};
    assert_int_equal(source_line(&source, 3), 2);
}

static void columns_are_characters_and_not_bytes(void **state)
{
    (void)state;
    assert_string_equal(point_at("\u00e4\u20ac\U0001f600: x", 5, 6).text,
                        "x.yaml:1:6: here\n    \u00e4\u20ac\U0001f600: x\n         ^");
}

static void a_place_beyond_the_end_shows_no_line(void **state)
{
    (void)state;
    assert_string_equal(point_at("a\n", 100, 101).text, "x.yaml:2:1: here");
    assert_string_equal(point_at("", 0, 0).text, "x.yaml:1:1: here");
}

static void a_long_line_is_cut_on_both_sides(void **state)
{
    (void)state;
    char text[1001];
    memset(text, 'x', 1000);
    text[1000] = '\0';
    text[500] = 'Y';
    const Err err = point_at(text, 500, 501);
    const char *line = strchr(err.text, '\n') + 1;
    const char *below = strchr(line, '\n') + 1;
    assert_true(below - line < 120);
    assert_int_equal(line[strlen(below) - 1], 'Y');
    assert_non_null(strstr(err.text, "    ...xxx"));
    assert_non_null(strstr(err.text, "xxx...\n"));
}

static void an_option_has_no_line_and_is_a_usage_error(void **state)
{
    (void)state;
    const char *text = "--set a=b";
    const Source source = {
        .name = text, .text = text, .size = strlen(text), .shift = 8, .is_option = true};
    Err err = {0};
    assert_false(source_error(&source, (Span){0, 1}, "c", &err, "no %s", "good"));
    assert_int_equal(err.kind, ERR_USAGE);
    assert_string_equal(err.text, "--set a=b: no good\n    --set a=b\n            ^\nallowed: c");
}

static void a_character_cut_in_a_message_is_mended(void **state)
{
    (void)state;
    const Source source = {.name = "x", .text = "", .size = 0};
    Err err = {0};
    source_error(&source, (Span){0, 0}, NULL, &err, "'%.1s' and '%s'", "\u00e4", "\u00e4\u20ac");
    assert_string_equal(err.text, "x:1:1: '?' and '\u00e4\u20ac'");
}

static void text_ends_where_it_is_no_text(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t length;
    } CASES[] = {
        {"plain\ttext\r\n", 12},
        {"\u00e4\u20ac\U0001f600", 9},
        {"a\x1b[m", 1},
        {"a\x7f", 1},
        {"a\xff", 1},
        {"a\xc3", 1},             // cut
        {"a\xc0\xaf", 1},         // overlong
        {"a\xe0\x80\xaf", 1},     // overlong
        {"a\xed\xa0\x80", 1},     // surrogate
        {"a\xf4\x90\x80\x80", 1}, // beyond the end of Unicode
        {"a\xc2\x9b", 1},         // control sequence introducer
        {"a\xef\xbf\xbf", 1},     // no character
        {"a\xe2\x28\xa1", 1},
        {"a\x80", 1},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        assert_int_equal(source_text_length(CASES[i].text, strlen(CASES[i].text)), CASES[i].length);
    }
    assert_int_equal(source_text_length("a\0b", 3), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_caret_stands_below_its_character),
        cmocka_unit_test(every_kind_of_line_break_counts_once),
        cmocka_unit_test(columns_are_characters_and_not_bytes),
        cmocka_unit_test(a_place_beyond_the_end_shows_no_line),
        cmocka_unit_test(a_long_line_is_cut_on_both_sides),
        cmocka_unit_test(an_option_has_no_line_and_is_a_usage_error),
        cmocka_unit_test(a_character_cut_in_a_message_is_mended),
        cmocka_unit_test(text_ends_where_it_is_no_text),
    };
    return cmocka_run_group_tests_name("source", tests, NULL, NULL);
}

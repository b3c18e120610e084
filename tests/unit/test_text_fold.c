// Do lines break where they may, and nowhere else?
#include "base/text.h"

#include "close.h"

#include <string.h>

static void check(const char *line, size_t width, const char *expected)
{
    Text text;
    text_init(&text);
    text_append(&text, "%s", line);
    text_fold(&text, width);
    assert_string_equal(text.data, expected);
    text_finish(&text);
}

static void a_folded_number_stays_with_its_unit(void **state)
{
    (void)state;
    check("  the longest step is 100 us here\n", 26, "  the longest step is\n  100 us here\n");
}

static void a_number_at_the_beginning_of_a_line_is_no_place_to_break(void **state)
{
    (void)state;
    check("  restitution of about 0.868 to 0.874 where that is asked\n", 28,
          "  restitution of about\n  0.868 to 0.874 where that\n  is asked\n");
    // control: without a unit after it the number may end a line
    check("  restitution of about 0.868 instead of what is asked\n", 28,
          "  restitution of about 0.868\n  instead of what is asked\n");
}

static void words_stand_under_the_words_of_their_entry(void **state)
{
    (void)state;
    check("  mass        0.1611 kg, the median of all that there are\n", 40,
          "  mass        0.1611 kg, the median of\n              all that there are\n");
}

static void what_has_no_other_blank_is_broken_before_a_unit(void **state)
{
    (void)state;
    check("  aaaaaaaaaaaaaaaa1 kg bbbbbbbbbbbbbbbbbbbbbbbbbbbbb\n", 24,
          "  aaaaaaaaaaaaaaaa1 kg\n  bbbbbbbbbbbbbbbbbbbbbbbbbbbbb\n");
}

static void what_stands_in_front_is_not_folded(void **state)
{
    (void)state;
    Text text;
    text_init(&text);
    text_append(&text, "one two three four five\n");
    const size_t start = text.length;
    text_append(&text, "one two three four five\n");
    text_fold_behind(&text, start, 14);
    assert_string_equal(text.data, "one two three four five\none two three\nfour five\n");
    // the control: all of it
    text_fold(&text, 14);
    assert_string_equal(text.data, "one two three\nfour five\none two three\nfour five\n");
    text_finish(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_folded_number_stays_with_its_unit),
        cmocka_unit_test(a_number_at_the_beginning_of_a_line_is_no_place_to_break),
        cmocka_unit_test(words_stand_under_the_words_of_their_entry),
        cmocka_unit_test(what_has_no_other_blank_is_broken_before_a_unit),
        cmocka_unit_test(what_stands_in_front_is_not_folded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

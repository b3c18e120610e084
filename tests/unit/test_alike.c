// What is said of many things alike is said once, with their names.
#include "write/alike.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <string.h>

static Text text;

static int begin(void **state)
{
    (void)state;
    text_init(&text);
    return 0;
}

static int end(void **state)
{
    (void)state;
    text_finish(&text);
    return 0;
}

static void things_of_which_the_same_is_said_share_a_line(void **state)
{
    (void)state;
    Alike *alike = alike_start();
    alike_add(alike, "a", "10 mm");
    alike_add(alike, "b", "20 mm\n  and long");
    alike_add(alike, "c", "10 mm");
    alike_end(alike, "  play  ", ": ", 80, &text);
    assert_string_equal(text.data, "  play  a, c: 10 mm\n"
                                   "  play  b: 20 mm\n  and long\n");
}

static void many_names_are_counted(void **state)
{
    (void)state;
    Alike *alike = alike_start();
    for (int i = 0; i < 1000; i++) {
        char name[16];
        snprintf(name, sizeof name, "pin-%d", i);
        alike_add(alike, name, "10 mm");
    }
    alike_end(alike, "", ": ", 80, &text);
    assert_string_equal(text.data, "pin-0, pin-1, pin-2 and 997 more: 10 mm\n");
}

// All of them only where lines have no width, as in files.
static void of_many_sentences_the_first_are_shown(void **state)
{
    (void)state;
    for (int round = 0; round < 2; round++) {
        Alike *alike = alike_start();
        for (int i = 0; i < 50; i++) {
            char number[16];
            snprintf(number, sizeof number, "%d", i);
            alike_add(alike, "pin", number);
        }
        alike_end(alike, "", " ", round == 0 ? 80 : 0, &text);
        size_t lines = 0;
        for (const char *at = text.data; *at != '\0'; at++) {
            lines += *at == '\n' ? 1 : 0;
        }
        assert_int_equal(lines, round == 0 ? 11 : 11 + 50);
    }
    assert_non_null(strstr(text.data, "... and 40 lines more, which --wide shows\n"));
}

static void nothing_said_is_nothing(void **state)
{
    (void)state;
    alike_end(alike_start(), "  play  ", ": ", 80, &text);
    assert_string_equal(text.data, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(things_of_which_the_same_is_said_share_a_line, begin, end),
        cmocka_unit_test_setup_teardown(many_names_are_counted, begin, end),
        cmocka_unit_test_setup_teardown(of_many_sentences_the_first_are_shown, begin, end),
        cmocka_unit_test_setup_teardown(nothing_said_is_nothing, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Are the last words of a process heard, and only the last?
#include "commands/study/worker.h"

#include "close.h"
#include "measure/child.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LINE_SIZE = 80, MUCH = 1 << 16 };

typedef struct Speech {
    int place;
    const char *words;
    int times;
} Speech;

static void speak(const void *context, void *result)
{
    const Speech *speech = context;
    last_words_listen(speech->place);
    for (int i = 0; i < speech->times; i++) {
        fputs(speech->words, i % 2 == 0 ? stderr : stdout);
    }
    fflush(stdout);
    *(int *)result = 1;
}

// What is heard of a child that says that, so many times.
static void hear(int place, const char *words, int times, char line[LINE_SIZE])
{
    const Speech speech = {place, words, times};
    Child child;
    Err err = {0};
    int result = 0;
    last_words_clear(place);
    assert_true(
        child_start(&child, speak, &speech, &result, sizeof result, (ChildLimits){0}, &err));
    while (child.end == CHILD_RUNNING) {
        child_wait(&child, 1, 1.0);
    }
    // who says too much is not ended for it
    assert_int_equal(child.end, CHILD_DONE);
    last_words_read(place, line, LINE_SIZE);
}

static void the_last_line_is_heard_and_earlier_ones_are_forgotten(void **state)
{
    (void)state;
    const int place = last_words_open();
    char line[LINE_SIZE];
    assert_true(place >= 0);
    hear(place, "first\nsecond\n\n \n", 1, line);
    assert_string_equal(line, "second");
    hear(place, "no end of line", 1, line);
    assert_string_equal(line, "no end of line");
    hear(place, "", 1, line);
    assert_string_equal(line, "");
    last_words_close(place);
}

static void a_line_that_is_long_or_no_text_is_cut_to_what_can_be_read(void **state)
{
    (void)state;
    const int place = last_words_open();
    char line[LINE_SIZE];
    hear(place, "\x01\x80 tab\t", 2, line);
    assert_string_equal(line, "?? tab??? tab");
    hear(place, "0123456789", 2000, line);
    assert_int_equal(strlen(line), LINE_SIZE - 1);
    last_words_close(place);
}

static void too_many_words_are_dropped_and_end_no_one(void **state)
{
    (void)state;
    const int place = last_words_open();
    char line[LINE_SIZE];
    hear(place, "the same again and again\n", MUCH, line);
    assert_non_null(strstr(line, "the same again"));
    last_words_close(place);
}

static void without_a_place_words_are_lost_and_nothing_else(void **state)
{
    (void)state;
    char line[LINE_SIZE] = "before";
    hear(-1, "words\n", 1, line);
    assert_string_equal(line, "");
    last_words_close(-1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_last_line_is_heard_and_earlier_ones_are_forgotten),
        cmocka_unit_test(a_line_that_is_long_or_no_text_is_cut_to_what_can_be_read),
        cmocka_unit_test(too_many_words_are_dropped_and_end_no_one),
        cmocka_unit_test(without_a_place_words_are_lost_and_nothing_else),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

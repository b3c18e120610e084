// Is the list of numbers in docs/output.md that of the program? Runs in the source root; with
// --write it writes the page with the list as it should be to standard output.
#include "close.h"

#include "base/text.h"
#include "model/numbers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char BEGIN[] = "### Numbers\n";
static const char FIRST[] = "\nOf a body:\n";
static const char END[] = "\n### Joints\n";

// How the page calls an owner; NULL: another stands for it.
static const char *const OWNERS[NUMBER_OWNER_COUNT] = {
    [NUMBER_OWNER_BODY] = "a body",
    [NUMBER_OWNER_JOINT] = "a joint",
    [NUMBER_OWNER_JOINT_SPIKE] = "a spike",
    [NUMBER_OWNER_JOINT_CONTACT] = "a contact",
    [NUMBER_OWNER_JOINT_WEAR] = "the wear of a pin, in `wear` of its joint",
    [NUMBER_OWNER_RUN] = "a run",
    [NUMBER_OWNER_ENERGY] = "`energy`",
    [NUMBER_OWNER_COST] = "what a run takes",
    [NUMBER_OWNER_ERROR] = "`error`",
    [NUMBER_OWNER_TRUTH] = "the reference, in `error`",
};

static char *page(void)
{
    enum { PAGE_SIZE = 1 << 18 };
    char *kept = calloc(1, PAGE_SIZE);
    assert_non_null(kept);
    FILE *file = fopen("docs/output.md", "rb");
    assert_non_null(file);
    assert_true(fread(kept, 1, PAGE_SIZE - 1, file) > 0);
    fclose(file);
    return kept;
}

// The keys of a number, one for each unit that its owner has.
static void append_keys(const Number *number, Text *text)
{
    const bool is_of_joint = NUMBER_OWNERS[number->owner].members == NUMBER_OF_JOINTS;
    const char *key = number->keys[NUMBER_PUSHED];
    const char *sped = number->keys[NUMBER_SPED];
    text_append(text, "`%s`", key);
    if (is_of_joint && strcmp(key, number->keys[NUMBER_TURNED]) != 0) {
        text_append(text, ", `%s`", number->keys[NUMBER_TURNED]);
    }
    if (number->owner == NUMBER_OWNER_JOINT_SPIKE && strcmp(key, sped) != 0) {
        text_append(text, ", `%s`", sped);
    }
    if ((number->traits & (NUMBER_TIMED | NUMBER_INSTANT)) != 0) {
        text_append(text, ", `%s`", number->crank_key);
    }
}

static void append_places(unsigned places, Text *text)
{
    static const struct {
        unsigned place;
        const char *word;
    } PLACES[] = {{NUMBER_STUDY, "S"}, {NUMBER_CHECK, "C"}, {NUMBER_EXPECT, "E"}};
    text_append(text, (places & (NUMBER_STUDY | NUMBER_CHECK | NUMBER_EXPECT)) != 0 ? " " : "");
    for (size_t i = 0; i < sizeof PLACES / sizeof *PLACES; i++) {
        text_append(text, "%s", (places & PLACES[i].place) != 0 ? PLACES[i].word : "");
    }
}

static Text list(void)
{
    Text text;
    text_init(&text);
    NumberOwner last = NUMBER_OWNER_COUNT;
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const Number *number = &NUMBERS[id];
        if ((number->places & NUMBER_JSON) == 0 || number->owner == NUMBER_OWNER_BODY_SPIKE) {
            continue;
        }
        if (number->owner != last) {
            assert_non_null(OWNERS[number->owner]);
            text_append(&text, "\nOf %s:\n\n", OWNERS[number->owner]);
            last = number->owner;
        }
        text_append(&text, "- ");
        append_keys(number, &text);
        append_places(number->places, &text);
        text_append(&text, ": %s%s\n", number->meaning,
                    (number->traits & NUMBER_PLAY) != 0 ? "; with play" : "");
    }
    return text;
}

// Where the list begins in the page, and how long it is.
static char *find_list(char *whole, size_t *length)
{
    char *begin = strstr(whole, BEGIN);
    assert_non_null(begin);
    begin = strstr(begin, FIRST);
    assert_non_null(begin);
    const char *end = strstr(begin, END);
    assert_non_null(end);
    *length = (size_t)(end - begin);
    return begin;
}

static void the_numbers_are_those_of_the_program(void **state)
{
    (void)state;
    char *whole = page();
    size_t length;
    char *rows = find_list(whole, &length);
    rows[length] = '\0';
    Text text = list();
    assert_string_equal(rows, text.data);
    // the control: a row that is another
    rows[strlen("\nOf ")] = 'x';
    assert_string_not_equal(rows, text.data);
    text_finish(&text);
    free(whole);
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--write") == 0) {
        char *whole = page();
        size_t length;
        const char *rows = find_list(whole, &length);
        Text text = list();
        printf("%.*s%s%s", (int)(rows - whole), whole, text.data, rows + length);
        text_finish(&text);
        free(whole);
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_numbers_are_those_of_the_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Is the table of the numbers of a joint in docs/output.md that of the program? Runs in the source
// root; with --write it writes the page with the table as it should be to standard output.
#include "close.h"

#include "base/text.h"
#include "model/joint_numbers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char BEGIN[] = "| number of a joint | at limits of a pivot | of | meaning |\n"
                            "|---|---|---|---|\n";

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

static Text table(void)
{
    Text text;
    text_init(&text);
    for (JointNumberId id = 0; id < JOINT_NUMBER_COUNT; id++) {
        const JointNumber *number = &JOINT_NUMBERS[id];
        text_append(&text, "| `%s`", number->keys[false]);
        if (number->is_timed) {
            text_append(&text, ", `%s`", number->crank_key);
        }
        text_append(&text, " | `%s` | %s | %s%s |\n", number->keys[true],
                    number->is_of_play ? "joints with play" : "every joint", number->meaning,
                    number->is_timed ? "; the crank angle at which it stands" : "");
    }
    return text;
}

// Where the rows of the table begin in the page, and how long they are.
static char *find_rows(char *whole, size_t *length)
{
    char *begin = strstr(whole, BEGIN);
    assert_non_null(begin);
    begin += strlen(BEGIN);
    const char *end = strstr(begin, "\n\n");
    assert_non_null(end);
    *length = (size_t)(end - begin) + 1;
    return begin;
}

static void the_numbers_of_a_joint_are_those_of_the_program(void **state)
{
    (void)state;
    char *whole = page();
    size_t length;
    char *rows = find_rows(whole, &length);
    rows[length] = '\0';
    Text text = table();
    assert_string_equal(rows, text.data);
    // the control: a row that is another
    rows[strlen("| `f")] = 'x';
    assert_string_not_equal(rows, text.data);
    text_finish(&text);
    free(whole);
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--write") == 0) {
        char *whole = page();
        size_t length;
        const char *rows = find_rows(whole, &length);
        Text text = table();
        printf("%.*s%s%s", (int)(rows - whole), whole, text.data, rows + length);
        text_finish(&text);
        free(whole);
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_numbers_of_a_joint_are_those_of_the_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

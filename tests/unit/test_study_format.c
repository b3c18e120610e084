// Does docs/study-format.md say what the program does, and can the example of `help study` be read?
// Runs in the source root; with --write it writes the page to standard output instead.
#include "study_file.h"

#include <stdio.h>
#include <stdlib.h>

static Text page(bool is_markdown)
{
    Text text;
    text_init(&text);
    spec_describe(is_markdown, &text);
    return text;
}

static void the_page_is_what_the_program_describes(void **state)
{
    (void)state;
    enum { PAGE_SIZE = 1 << 16 };
    char *kept = calloc(1, PAGE_SIZE);
    assert_non_null(kept);
    FILE *file = fopen("docs/study-format.md", "rb");
    assert_non_null(file);
    assert_true(fread(kept, 1, PAGE_SIZE - 1, file) > 0);
    fclose(file);
    Text text = page(true);
    assert_string_equal(kept, text.data);
    text_finish(&text);
    free(kept);
}

static void words_for_a_terminal_fit_its_width(void **state)
{
    (void)state;
    Text text = page(false);
    for (const char *line = text.data; *line != '\0'; line += strcspn(line, "\n") + 1) {
        assert_in_range(strcspn(line, "\n"), 0, 80);
    }
    assert_non_null(strstr(text.data, "    draw.keys.KEY.normal.deviation\n"));
    assert_non_null(strstr(text.data, "    error_reference_uncertainty\n"));
    text_finish(&text);
}

// The example as everyone will copy it, of a case that is there.
static void the_example_is_a_study(void **state)
{
    (void)state;
    Text text = page(false);
    const char *start = strstr(text.data, "vary:\n");
    assert_non_null(start);
    char *end = strstr(start, "\n\n");
    assert_non_null(end);
    *end = '\0';
    Spec spec = study_read("paper/impact-k66.yaml", start);
    assert_int_equal(design_run_count(&spec), 15 * 2 * 8 * 100);
    spec_finish(&spec);
    text_finish(&text);
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--write") == 0) {
        Text text = page(true);
        fputs(text.data, stdout);
        text_finish(&text);
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_page_is_what_the_program_describes),
        cmocka_unit_test(words_for_a_terminal_fit_its_width),
        cmocka_unit_test(the_example_is_a_study),
    };
    return cmocka_run_group_tests_name("study_format", tests, NULL, NULL);
}

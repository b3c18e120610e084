// Does docs/case-format.md say what the program does? Runs in the source root; with --write it
// writes the page to standard output instead.
#include "casefile/casefile.h"
#include "casefile/schema.h"

#include "close.h"
#include "kept.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void the_page_is_what_the_program_describes(void **state)
{
    (void)state;
    enum { PAGE_SIZE = 1 << 16 };
    char *page = calloc(1, PAGE_SIZE);
    assert_non_null(page);
    FILE *file = fopen("docs/case-format.md", "rb");
    assert_non_null(file);
    const size_t length = fread(page, 1, PAGE_SIZE - 1, file);
    fclose(file);
    Text text;
    text_init(&text);
    casefile_describe_markdown(&text);
    assert_int_equal(length, text.length);
    assert_string_equal(page, text.data);
    text_finish(&text);
    free(page);
}

static void both_descriptions_name_every_key(void **state)
{
    (void)state;
    Text page;
    Text words;
    text_init(&page);
    text_init(&words);
    casefile_describe_markdown(&page);
    casefile_describe_all(80, &words);
    const Scenario scenario = kept_default();
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(&scenario);
    while (casefile_next(&walk, &setting)) {
        // the last part of the key: names of joints and points are placeholders there
        const char *dot = strrchr(setting.key, '.');
        const char *last = dot != NULL ? dot + 1 : setting.key;
        assert_non_null(strstr(page.data, last));
        assert_non_null(strstr(words.data, last));
    }
    assert_non_null(strstr(page.data, "- `material.youngs-modulus` ("));
    assert_non_null(strstr(page.data, "2.07e+11 Pa"));
    text_finish(&page);
    text_finish(&words);
}

static bool explains(const SchemaRow *row, const char *word)
{
    char explained[64];
    snprintf(explained, sizeof explained, "%s: ", word);
    return strstr(row->doc, explained) != NULL;
}

// Where the meaning of a choice explains its words one by one, it has all of them.
static void a_choice_explains_each_word_or_none(void **state)
{
    (void)state;
    size_t explained = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        if (row->type != SCHEMA_CHOICE || !explains(row, row->words[0])) {
            continue;
        }
        for (size_t k = 0; row->words[k] != NULL; k++) {
            if (!explains(row, row->words[k])) {
                fail_msg("the doc of %s in casefile/schema_table.c explains '%s' and not '%s'",
                         row->path, row->words[0], row->words[k]);
            }
            explained++;
        }
    }
    assert_true(explained > 10);
}

// A mistake in any group is answered with all that is allowed there.
static void there_is_room_for_the_keys_of_every_group(void **state)
{
    (void)state;
    char names[SCHEMA_CHILD_MAX][LINKAGE_NAME_SIZE];
    size_t most = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        char group[SCHEMA_PATH_SIZE];
        snprintf(group, sizeof group, "%s", SCHEMA_ROWS[i].path);
        for (char *dot = strrchr(group, '.'); dot != NULL; dot = strrchr(group, '.')) {
            *dot = '\0';
            for (size_t form = 0; form < SCHEMA_FORM_COUNT; form++) {
                const size_t count = schema_children(group, SCHEMA_FORMS[form].form, names);
                most = count > most ? count : most;
            }
        }
    }
    assert_in_range(most, 12, SCHEMA_CHILD_MAX);
}

static void check_width(const Text *words, size_t width)
{
    for (const char *line = words->data; *line != '\0'; line += strcspn(line, "\n") + 1) {
        if (strcspn(line, "\n") > width) {
            fail_msg("more than %zu columns: %.*s", width, (int)strcspn(line, "\n"), line);
        }
    }
}

static void words_for_a_terminal_fit_its_width(void **state)
{
    (void)state;
    for (int width = 80; width <= 100; width += 4) {
        Text words;
        text_init(&words);
        casefile_describe(width, &words);
        check_width(&words, (size_t)width);
        text_finish(&words);
        text_init(&words);
        casefile_describe_all(width, &words);
        check_width(&words, (size_t)width);
        text_finish(&words);
    }
}

// The overview is a screen or two, whatever the schema grows to, and leads to every section.
static void the_overview_names_every_section_once(void **state)
{
    (void)state;
    Text words;
    text_init(&words);
    casefile_describe(80, &words);
    for (size_t g = 1; g < SCHEMA_GROUP_COUNT; g++) {
        char line[64];
        snprintf(line, sizeof line, "\n  %s ", SCHEMA_GROUPS[g].path);
        const char *found = strstr(words.data, line);
        assert_non_null(found);
        assert_null(strstr(found + 1, line));
        Text part;
        Err err = {0};
        text_init(&part);
        assert_true(casefile_describe_part(SCHEMA_GROUPS[g].path, 80, &part, &err));
        text_finish(&part);
    }
    size_t lines = 0;
    for (const char *c = words.data; *c != '\0'; c++) {
        lines += *c == '\n' ? 1 : 0;
    }
    assert_in_range(lines, 30, 64);
    text_finish(&words);
}

// Every key by its whole path and by its last word, with a name of somebody's own in it; what is
// none is answered with what may be meant.
static void every_key_is_found_by_its_path_and_by_its_last_word(void **state)
{
    (void)state;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        char path[SCHEMA_PATH_SIZE];
        schema_path(&SCHEMA_ROWS[i], "somebody", path);
        const char *dot = strrchr(path, '.');
        const char *const names[] = {path, dot != NULL ? dot + 1 : path};
        const bool is_own = dot != NULL && strcmp(dot, ".somebody") == 0;
        for (size_t k = 0; k < (is_own ? 1 : 2); k++) {
            Text part;
            Err err = {0};
            text_init(&part);
            if (!casefile_describe_part(names[k], 80, &part, &err)) {
                fail_msg("%s", err.text);
            }
            assert_non_null(strstr(part.data, is_own ? "signals." : names[1]));
            text_finish(&part);
        }
    }
    Text part;
    Err err = {0};
    text_init(&part);
    assert_false(casefile_describe_part("restitutoin", 80, &part, &err));
    assert_non_null(strstr(err.text, "did you mean 'restitution'?"));
    text_finish(&part);
}

// The example in the description, as everyone will copy it.
static void the_example_loads(void **state)
{
    (void)state;
    Text page;
    text_init(&page);
    casefile_describe_markdown(&page);
    const char *start = strstr(page.data, "```yaml\n");
    assert_non_null(start);
    start += strlen("```yaml\n");
    const char *end = strstr(start, "```");
    assert_non_null(end);
    Scenario scenario;
    Err err = {0};
    assert_true(
        casefile_load_text("example", start, (size_t)(end - start), NULL, 0, &scenario, &err));
    assert_true(scenario_has_clearance(&scenario));
    scenario_free(&scenario);
    text_finish(&page);
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--write") == 0) {
        Text text;
        text_init(&text);
        casefile_describe_markdown(&text);
        fputs(text.data, stdout);
        text_finish(&text);
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_page_is_what_the_program_describes),
        cmocka_unit_test(both_descriptions_name_every_key),
        cmocka_unit_test(the_overview_names_every_section_once),
        cmocka_unit_test(every_key_is_found_by_its_path_and_by_its_last_word),
        cmocka_unit_test(a_choice_explains_each_word_or_none),
        cmocka_unit_test(there_is_room_for_the_keys_of_every_group),
        cmocka_unit_test(words_for_a_terminal_fit_its_width),
        cmocka_unit_test(the_example_loads),
    };
    return cmocka_run_group_tests_name("case_format", tests, NULL, NULL);
}

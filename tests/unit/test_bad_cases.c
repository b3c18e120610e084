// Is each mistake told in the words, and at the place, that tests/bad/NAME.expected holds?
//
// Runs in the source root. One test a file; a .yaml without its .expected is a failure.
#include "casefile/casefile.h"

#include "close.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void check_message(void **state)
{
    const char *path = *state;
    char expected[ERR_TEXT_SIZE + 2] = "";
    char expected_path[512];
    snprintf(expected_path, sizeof expected_path, "%.*s.expected",
             (int)(strlen(path) - strlen(".yaml")), path);
    FILE *file = fopen(expected_path, "rb");
    if (file == NULL) {
        fail_msg("%s is missing", expected_path);
    }
    expected[fread(expected, 1, sizeof expected - 1, file)] = '\0';
    fclose(file);

    Scenario scenario = scenario_default();
    const Scenario before = scenario;
    Err err = {0};
    assert_false(casefile_load(path, NULL, 0, &scenario, &err));
    assert_int_equal(err.kind, ERR_CASE);
    // the file ends in a line feed, the message does not
    char message[ERR_TEXT_SIZE + 2];
    snprintf(message, sizeof message, "%s\n", err.text);
    assert_string_equal(message, expected);
    assert_memory_equal(&scenario, &before, sizeof scenario);
}

int main(void)
{
    glob_t files;
    if (glob("tests/bad/*.yaml", 0, NULL, &files) != 0) {
        fprintf(stderr, "no tests/bad/*.yaml here; run from the source root\n");
        return 1;
    }
    struct CMUnitTest *tests = calloc(files.gl_pathc, sizeof *tests);
    if (tests == NULL) {
        return 1;
    }
    for (size_t i = 0; i < files.gl_pathc; i++) {
        tests[i] = (struct CMUnitTest){
            .name = files.gl_pathv[i],
            .test_func = check_message,
            .initial_state = files.gl_pathv[i],
        };
    }
    // what the macro does, for a number of tests known only now
    const int failed = _cmocka_run_group_tests("bad_cases", tests, files.gl_pathc, NULL, NULL);
    free(tests);
    globfree(&files);
    return failed;
}

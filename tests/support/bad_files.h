// One test a bad file: it must be refused with the message in NAME.expected beside NAME.yaml. With
// --write the messages go there, to be read in the difference to what was there before.
#pragma once

#include "base/err.h"

#include "close.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Writes the message that a file has, with its line feed.
static inline void bad_files_write(const char *path, const char *message)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(message, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static bool bad_files_writes; // whether --write was given

// Fails unless the error is ERR_CASE with the message that stands beside the file.
static inline void bad_files_check(const char *path, const Err *err)
{
    char expected[ERR_TEXT_SIZE + 2] = "";
    char expected_path[512];
    snprintf(expected_path, sizeof expected_path, "%.*s.expected",
             (int)(strlen(path) - strlen(".yaml")), path);
    // the file ends in a line feed, the message does not
    char message[ERR_TEXT_SIZE + 2];
    snprintf(message, sizeof message, "%s\n", err->text);
    assert_int_equal(err->kind, ERR_CASE);
    if (bad_files_writes) {
        bad_files_write(expected_path, message);
        return;
    }
    FILE *file = fopen(expected_path, "rb");
    if (file == NULL) {
        fail_msg("%s is missing", expected_path);
    }
    expected[fread(expected, 1, sizeof expected - 1, file)] = '\0';
    fclose(file);
    assert_string_equal(message, expected);
}

// Runs a test for every file of the pattern, whose path is its state.
static inline int bad_files_run(int argc, char **argv, const char *pattern, CMUnitTestFunction test)
{
    bad_files_writes = argc == 2 && strcmp(argv[1], "--write") == 0;
    glob_t files;
    if (glob(pattern, 0, NULL, &files) != 0) {
        fprintf(stderr, "no %s here; run from the source root\n", pattern);
        return 1;
    }
    struct CMUnitTest *tests = calloc(files.gl_pathc, sizeof *tests);
    if (tests == NULL) {
        return 1;
    }
    for (size_t i = 0; i < files.gl_pathc; i++) {
        tests[i] = (struct CMUnitTest){
            .name = files.gl_pathv[i],
            .test_func = test,
            .initial_state = files.gl_pathv[i],
        };
    }
    // what the macro does, for a number of tests known only now
    const int failed = _cmocka_run_group_tests("bad_files", tests, files.gl_pathc, NULL, NULL);
    free(tests);
    globfree(&files);
    return failed;
}

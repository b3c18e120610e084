// Is a file written whole or not at all?
#include "report/file.h"

#include "scratch.h"

#include <string.h>
#include <sys/stat.h>

static void a_file_is_written_whole(void **state)
{
    (void)state;
    char path[256];
    char content[64];
    struct stat status;
    Err err = {0};
    scratch_path("whole.txt", path, sizeof path);
    assert_true(file_write_text(path, "first\n", &err));
    assert_true(file_write_text(path, "second\n", &err));
    read_whole(path, content, sizeof content);
    assert_string_equal(content, "second\n");
    assert_int_equal(stat(path, &status), 0);
    assert_true(S_ISREG(status.st_mode));
    unlink(path);
}

static void a_file_given_up_leaves_what_was_there(void **state)
{
    (void)state;
    char path[256];
    char content[64];
    WholeFile file;
    Err err = {0};
    scratch_path("kept.txt", path, sizeof path);
    assert_true(file_write_text(path, "old\n", &err));
    assert_true(file_begin(&file, path, &err));
    fputs("half of the n", file.stream);
    file_abandon(&file);
    assert_int_equal(access(file.temporary, F_OK), -1);
    read_whole(path, content, sizeof content);
    assert_string_equal(content, "old\n");
    unlink(path);
}

static void a_symbolic_link_stays_one(void **state)
{
    (void)state;
    char path[256];
    char link_path[256];
    char content[64];
    struct stat status;
    Err err = {0};
    scratch_path("target.txt", path, sizeof path);
    scratch_path("link.txt", link_path, sizeof link_path);
    assert_true(file_write_text(path, "old\n", &err));
    assert_int_equal(symlink(path, link_path), 0);
    assert_true(file_write_text(link_path, "new\n", &err));
    assert_int_equal(lstat(link_path, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    read_whole(path, content, sizeof content);
    assert_string_equal(content, "new\n");
    unlink(path);
    unlink(link_path);
}

static void a_file_that_cannot_be_written_is_an_error(void **state)
{
    (void)state;
    Err err = {0};
    assert_false(file_write_text("/dev/full", "words", &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_string_equal(err.text, "cannot write /dev/full: No space left on device");
    err = (Err){0};
    assert_false(file_write_text("/nowhere/at/all.txt", "words", &err));
    assert_string_equal(err.text, "cannot write /nowhere/at/all.txt: No such file or directory");
    err = (Err){0};
    assert_false(file_write_text("", "words", &err));
    assert_int_equal(err.kind, ERR_FILE);
    err = (Err){0};
    char long_path[2 * FILE_PATH_SIZE];
    memset(long_path, 'x', sizeof long_path - 1);
    long_path[sizeof long_path - 1] = '\0';
    assert_false(file_write_text(long_path, "words", &err));
    assert_int_equal(err.kind, ERR_FILE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_is_written_whole),
        cmocka_unit_test(a_file_given_up_leaves_what_was_there),
        cmocka_unit_test(a_symbolic_link_stays_one),
        cmocka_unit_test(a_file_that_cannot_be_written_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

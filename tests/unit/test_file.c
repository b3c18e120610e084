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

static void a_probe_leaves_nothing_behind(void **state)
{
    (void)state;
    char path[256];
    char inside[300];
    char content[64];
    Err err = {0};
    scratch_path("probed.txt", path, sizeof path);
    assert_true(file_probe(path, &err));
    assert_int_equal(access(path, F_OK), -1);
    // and leaves what is there as it is
    assert_true(file_write_text(path, "old\n", &err));
    assert_true(file_probe(path, &err));
    read_whole(path, content, sizeof content);
    assert_string_equal(content, "old\n");
    assert_true(file_probe("-", &err) && file_probe("/dev/null", &err));
    // what cannot be written: below a file, a folder
    snprintf(inside, sizeof inside, "%s/x", path);
    assert_false(file_probe(inside, &err));
    assert_int_equal(err.kind, ERR_FILE);
    err = (Err){0};
    assert_false(file_probe("/tmp", &err));
    assert_string_equal(err.text, "cannot write /tmp: Is a directory");
    unlink(path);
}

static void two_paths_to_one_file_are_the_same(void **state)
{
    (void)state;
    char path[256];
    char link_path[256];
    Err err = {0};
    assert_true(file_is_same("a.csv", "./a.csv"));
    assert_true(file_is_same("-", "-"));
    assert_false(file_is_same("a.csv", "b.csv"));
    assert_false(file_is_same("nowhere/a.csv", "a.csv"));
    assert_false(file_is_same(NULL, "a.csv"));
    scratch_path("one.txt", path, sizeof path);
    scratch_path("other.txt", link_path, sizeof link_path);
    assert_true(file_write_text(path, "old\n", &err));
    assert_int_equal(symlink(path, link_path), 0);
    assert_true(file_is_same(path, link_path));
    unlink(link_path);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_is_written_whole),
        cmocka_unit_test(a_file_given_up_leaves_what_was_there),
        cmocka_unit_test(a_symbolic_link_stays_one),
        cmocka_unit_test(a_file_that_cannot_be_written_is_an_error),
        cmocka_unit_test(a_probe_leaves_nothing_behind),
        cmocka_unit_test(two_paths_to_one_file_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

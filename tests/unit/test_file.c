// Is a file written whole or not at all?
#include "write/file.h"

#include "scratch.h"

#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

// two files of one kind
#define FIRST  "### jointplay check: first\n"
#define SECOND "### jointplay check: second\n"

static void a_file_is_written_whole(void **state)
{
    (void)state;
    char path[256];
    char content[64];
    struct stat status;
    Err err = {0};
    scratch_path("whole.txt", path, sizeof path);
    assert_true(file_write_text(FILE_COMMENT, path, FIRST, &err));
    assert_true(file_write_text(FILE_COMMENT, path, SECOND, &err));
    read_whole(path, content, sizeof content);
    assert_string_equal(content, SECOND);
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
    assert_true(file_write_text(FILE_COMMENT, path, FIRST, &err));
    assert_true(file_begin(&file, FILE_COMMENT, path, &err));
    fputs("half of the n", file.stream);
    file_abandon(&file);
    assert_int_equal(access(file.temporary, F_OK), -1);
    read_whole(path, content, sizeof content);
    assert_string_equal(content, FIRST);
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
    assert_true(file_write_text(FILE_COMMENT, path, FIRST, &err));
    assert_int_equal(symlink(path, link_path), 0);
    assert_true(file_write_text(FILE_COMMENT, link_path, SECOND, &err));
    assert_int_equal(lstat(link_path, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    read_whole(path, content, sizeof content);
    assert_string_equal(content, SECOND);
    unlink(path);
    unlink(link_path);
}

static void a_file_that_cannot_be_written_is_an_error(void **state)
{
    (void)state;
    Err err = {0};
    assert_false(file_write_text(FILE_COMMENT, "/dev/full", "words", &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_string_equal(err.text, "cannot write /dev/full: No space left on device");
    err = (Err){0};
    assert_false(file_write_text(FILE_COMMENT, "/nowhere/at/all.txt", "words", &err));
    assert_string_equal(err.text, "cannot write /nowhere/at/all.txt: No such file or directory");
    err = (Err){0};
    assert_false(file_write_text(FILE_COMMENT, "", "words", &err));
    assert_int_equal(err.kind, ERR_FILE);
    err = (Err){0};
    char long_path[2 * FILE_PATH_SIZE];
    memset(long_path, 'x', sizeof long_path - 1);
    long_path[sizeof long_path - 1] = '\0';
    assert_false(file_write_text(FILE_COMMENT, long_path, "words", &err));
    assert_int_equal(err.kind, ERR_FILE);
}

// Longer than any buffer, so that a write fails before the file is ended.
static const char *long_text(void)
{
    static char text[100000];
    memset(text, 'x', sizeof text - 1);
    return text;
}

static void the_reason_of_an_early_failure_is_kept(void **state)
{
    (void)state;
    Err err = {0};
    assert_false(file_write_text(FILE_COMMENT, "/dev/full", long_text(), &err));
    assert_string_equal(err.text, "cannot write /dev/full: No space left on device");
    WholeFile file;
    err = (Err){0};
    assert_true(file_begin(&file, FILE_COMMENT, "/dev/full", &err) && file_check(&file, &err));
    fputs(long_text(), file.stream);
    assert_false(file_check(&file, &err));
    assert_string_equal(err.text, "cannot write /dev/full: No space left on device");
    file_abandon(&file);
}

static void a_reader_that_has_gone_away_needs_no_words(void **state)
{
    (void)state;
    char path[256];
    scratch_path("pipe", path, sizeof path);
    assert_int_equal(mkfifo(path, 0600), 0);
    const int reader = open(path, O_RDONLY | O_NONBLOCK);
    WholeFile file;
    Err err = {0};
    signal(SIGPIPE, SIG_IGN);
    assert_true(file_begin(&file, FILE_COMMENT, path, &err));
    close(reader);
    fputs(long_text(), file.stream);
    assert_false(file_end(&file, &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_string_equal(err.text, "");
    unlink(path);
}

static int write_more_than_allowed(void)
{
    char path[256];
    Err err = {0};
    struct stat status;
    const struct rlimit limit = {50000, 50000};
    snprintf(path, sizeof path, "%s", getenv("LIMITED"));
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    return !file_write_text(FILE_COMMENT, path, long_text(), &err) &&
                   strstr(err.text, ": File too large") != NULL && stat(path, &status) == 0 &&
                   status.st_size == sizeof FIRST - 1
               ? 0
               : 1;
}

static void a_file_that_may_not_become_so_long_is_an_error(void **state)
{
    (void)state;
    char path[256];
    Err err = {0};
    scratch_path("limited.txt", path, sizeof path);
    assert_true(file_write_text(FILE_COMMENT, path, FIRST, &err));
    setenv("LIMITED", path, 1);
    fflush(stdout);
    const pid_t process = fork();
    if (process == 0) {
        _exit(write_more_than_allowed());
    }
    int status;
    waitpid(process, &status, 0);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    unlink(path);
}

static mode_t mode_of(const char *path)
{
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    return status.st_mode & 07777;
}

static void a_file_that_is_replaced_keeps_its_mode(void **state)
{
    (void)state;
    static const mode_t MODES[] = {0600, 0640, 0666, 0755};
    char path[256];
    Err err = {0};
    scratch_path("mode.txt", path, sizeof path);
    const mode_t former = umask(027);
    assert_true(file_write_text(FILE_COMMENT, path, FIRST, &err));
    assert_int_equal(mode_of(path), 0640);
    for (size_t i = 0; i < sizeof MODES / sizeof *MODES; i++) {
        assert_int_equal(chmod(path, MODES[i]), 0);
        assert_true(file_write_text(FILE_COMMENT, path, SECOND, &err));
        assert_int_equal(mode_of(path), MODES[i]);
    }
    umask(former);
    unlink(path);
}

// A process that was, and is no more.
static pid_t find_dead_process(void)
{
    const pid_t process = fork();
    if (process == 0) {
        _exit(0);
    }
    waitpid(process, NULL, 0);
    return process;
}

static int make_part(const char *path, long process, char *part, size_t size)
{
    snprintf(part, size, "%s.part-%ld", path, process);
    return open(part, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
}

static void what_a_killed_process_left_is_taken_away(void **state)
{
    (void)state;
    char path[256];
    char dead[300];
    char living[300];
    char locked[300];
    char other[300];
    char content[64];
    Err err = {0};
    scratch_path("left.txt", path, sizeof path);
    close(make_part(path, find_dead_process(), dead, sizeof dead));
    close(make_part(path, getppid(), living, sizeof living));
    // of a process of another machine, on a disk that both have
    const int lock = make_part(path, find_dead_process(), locked, sizeof locked);
    assert_int_equal(work_lock_take(lock, 0), 0);
    snprintf(other, sizeof other, "%s.part-1x", path);
    close(open(other, O_RDWR | O_CREAT | O_CLOEXEC, 0600));
    assert_true(file_write_text(FILE_COMMENT, path, FIRST, &err));
    read_whole(path, content, sizeof content);
    assert_string_equal(content, FIRST);
    assert_int_equal(access(dead, F_OK), -1);
    // the controls
    assert_int_equal(access(living, F_OK), 0);
    assert_int_equal(access(locked, F_OK), 0);
    assert_int_equal(access(other, F_OK), 0);
    close(lock);
    assert_true(file_claim("--markdown", FILE_COMMENT, path, &err));
    assert_int_equal(access(locked, F_OK), -1);
    unlink(living);
    unlink(other);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_is_written_whole),
        cmocka_unit_test(a_file_given_up_leaves_what_was_there),
        cmocka_unit_test(a_symbolic_link_stays_one),
        cmocka_unit_test(a_file_that_cannot_be_written_is_an_error),
        cmocka_unit_test(the_reason_of_an_early_failure_is_kept),
        cmocka_unit_test(a_reader_that_has_gone_away_needs_no_words),
        cmocka_unit_test(a_file_that_may_not_become_so_long_is_an_error),
        cmocka_unit_test(a_file_that_is_replaced_keeps_its_mode),
        cmocka_unit_test(what_a_killed_process_left_is_taken_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Does output that cannot be written say why, or nothing where nobody reads it?
#include "program.h"

#include <sys/stat.h>

// Runs a line of a shell in the program's folder: $jointplay is the program, $cases the cases. What
// clang's coverage says there of its own files, which a limit on files meets too, is left out.
static void run_line(Program *program, const char *line)
{
    char command[4 * PROGRAM_PATH_SIZE];
    char path[PROGRAM_PATH_SIZE];
    snprintf(command, sizeof command,
             "cd '%s' && jointplay=$JOINTPLAY_PROGRAM && cases=$JOINTPLAY_CASES && "
             "{ %s; } >.output 2>.errors; status=$?; sed -i '/^prof/d' .errors; exit $status",
             program->folder, line);
    const int status = system(command);
    program->status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    program_path(program, ".output", path);
    program_read(path, program->output);
    program_path(program, ".errors", path);
    program_read(path, program->errors);
}

static void run_well(Program *program, const char *line)
{
    run_line(program, line);
    if (program->status != 0) {
        fail_msg("%s: status %d: %s", line, program->status, program->errors);
    }
}

// The reader is gone before the program is started.
static void a_closed_pipe_is_silent(void **state)
{
    Program *program = *state;
    static const char *const WORDS[] = {
        "help case",
        "paper",
        "run $cases/paper/ideal-nominal.yaml --set run.samples=36 --json -q",
        "run $cases/paper/ideal-nominal.yaml --set run.samples=3600 --series - -q",
        "run $cases/paper/ideal-nominal.yaml --set run.samples=360 --plot /dev/stdout -q",
        "map $cases/paper/impact-k66.yaml --steps '10 us' --csv - -q",
    };
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++) {
        char line[PROGRAM_PATH_SIZE];
        snprintf(line, sizeof line, "{ sleep 0.05; $jointplay %s; echo status $? >&2; } | true",
                 WORDS[i]);
        run_well(program, line);
        assert_string_equal(program->errors, "status 5\n");
    }
}

static void a_full_disk_is_named_whatever_the_length(void **state)
{
    Program *program = *state;
    static const char *const WORDS[] = {"help", "help case",
                                        "run $cases/paper/ideal-nominal.yaml --json -q"};
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++) {
        char line[PROGRAM_PATH_SIZE];
        snprintf(line, sizeof line, "$jointplay %s >/dev/full", WORDS[i]);
        run_line(program, line);
        assert_int_equal(program->status, 5);
        assert_string_equal(program->errors,
                            "jointplay: cannot write standard output: No space left on device\n");
    }
}

// A limit on the size of files, in blocks of 512 bytes. Counts of coverage, where the program makes
// them, go elsewhere, for each run anew: cut off they would spoil those of the build or of the next
// run, with words about it.
#define FILE_LIMIT(blocks)                                                                         \
    "rm -rf gcov; export GCOV_PREFIX=\"$PWD/gcov\" GCOV_ERROR_FILE=/dev/null; ulimit -f " blocks   \
    "; "

static void a_limit_on_files_is_an_error(void **state)
{
    Program *program = *state;
    static const char RUN[] =
        "$jointplay run $cases/paper/ideal-nominal.yaml --backend analytic -q ";
    char line[PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line, FILE_LIMIT("16") "%s --series k.csv", RUN);
    run_line(program, line);
    assert_int_equal(program->status, 5);
    assert_string_equal(program->errors, "jointplay: cannot write k.csv: File too large\n");
    run_well(program, "ls");
    assert_null(strstr(program->output, "k."));
    run_line(program,
             FILE_LIMIT("4") "$jointplay compare $cases/paper/ideal-nominal.yaml -q "
                             "--schemes direct/plain --steps '100 us' --set run.samples=36 "
                             "--store c.jsonl");
    assert_int_equal(program->status, 5);
    assert_string_equal(program->errors,
                        "jointplay: cannot write the store c.jsonl: File too large\n");
    run_line(program, "printf 'title: t\ncase: %s\nvary: {drive.speed: [900 rpm]}\n' "
                      "$cases/paper/ideal-nominal.yaml >s.yaml; " FILE_LIMIT(
                          "16") "$jointplay study s.yaml -q");
    assert_int_equal(program->status, 5);
    assert_string_equal(program->errors,
                        "jointplay: cannot write the store s.sqlite: File too large\n");
}

static void a_file_keeps_its_mode(void **state)
{
    Program *program = *state;
    static const char RUN[] =
        "$jointplay run $cases/paper/ideal-nominal.yaml --backend analytic -q ";
    char line[PROGRAM_PATH_SIZE];
    struct stat status;
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "k.csv", path);
    snprintf(line, sizeof line, "umask 022; %s --series k.csv >&2", RUN);
    run_well(program, line);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0644);
    assert_int_equal(chmod(path, 0600), 0);
    run_well(program, line);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define WRITE_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)
        WRITE_TEST(a_closed_pipe_is_silent),
        WRITE_TEST(a_full_disk_is_named_whatever_the_length),
        WRITE_TEST(a_limit_on_files_is_an_error),
        WRITE_TEST(a_file_keeps_its_mode),
#undef WRITE_TEST
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Does a caller who closed a standard stream lose anything by it?
#include "program.h"

enum { RUNS = 4 };

// Two runs that end well and two that take longer than they may, so that there is something to make
// again.
static const char STUDY[] = "title: A study without a terminal\n"
                            "case: %s/paper/ideal-nominal.yaml\n"
                            "set: {run.samples: 360}\n"
                            "vary:\n"
                            "  run.step: [10 us, 20 us]\n"
                            "  run.revolutions: [1, 100000]\n"
                            "limits: {time: 1 s}\n"; // many times what a run of one turn takes with
                                                     // sanitizers on a busy machine

static void write_study(const Program *program)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "s.yaml", path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream, STUDY, getenv("JOINTPLAY_CASES"));
    fclose(stream);
}

// The exit status with some streams closed: "2>&-".
static int run_closed(const Program *program, const char *words, const char *closed)
{
    char command[4 * PROGRAM_PATH_SIZE];
    snprintf(command, sizeof command,
             "cd '%s' && cases=$JOINTPLAY_CASES && \"$JOINTPLAY_PROGRAM\" %s >.output 2>.errors "
             "<.output %s",
             program->folder, words, closed);
    const int status = system(command);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static const char *const CLOSED[] = {"2>&-", ">&-", "<&-", "2>&- >&- <&-"};
enum { CLOSED_COUNT = sizeof CLOSED / sizeof *CLOSED };

// The store has every run, and each of them reads back.
static void check_store(Program *program, const char *closed)
{
    program_run(program, "study export s.sqlite");
    if (program->status != 0) {
        fail_msg("after %s: %s", closed, program->errors);
    }
    size_t lines = 0;
    for (const char *c = program->output; *c != '\0'; c++) {
        lines += *c == '\n' ? 1 : 0;
    }
    assert_int_equal(lines, 1 + RUNS);
}

static void a_study_keeps_its_store(void **state)
{
    Program *program = *state;
    write_study(program);
    program_run(program, "study s.yaml");
    assert_int_equal(program->status, 0);
    check_store(program, "the first");
    for (int i = 0; i < CLOSED_COUNT; i++) {
        const bool has_output = strchr(CLOSED[i], ' ') == NULL && CLOSED[i][0] != '>';
        assert_int_equal(run_closed(program, "study s.yaml --retry-failed", CLOSED[i]),
                         has_output ? 0 : 5);
        check_store(program, CLOSED[i]);
    }
}

static void a_comparison_keeps_its_store(void **state)
{
    Program *program = *state;
    static const char WORDS[] = "compare $cases/paper/ideal-nominal.yaml --store j.jsonl "
                                "--schemes direct/plain --steps '100 us' --set run.samples=360";
    program_run(program, WORDS);
    assert_int_equal(program->status, 0);
    for (int i = 0; i < CLOSED_COUNT; i++) {
        const bool has_output = strchr(CLOSED[i], ' ') == NULL && CLOSED[i][0] != '>';
        // it says what it took from the store
        assert_int_equal(run_closed(program, WORDS, CLOSED[i]), has_output ? 0 : 5);
        program_run(program, WORDS);
        if (program->status != 0) {
            fail_msg("after %s: %s", CLOSED[i], program->errors);
        }
        assert_says(program->errors, "from the store j.jsonl");
    }
}

static void a_closed_stream_is_of_no_use_still(void **state)
{
    Program *program = *state;
    static const struct {
        const char *words, *closed, *message;
    } ASKED[] = {
        {"help", ">&-", "cannot write standard output: Bad file descriptor"},
        {"map $cases/paper/impact-k66.yaml --steps '10 us' --csv - -q", ">&-",
         "cannot write -: Bad file descriptor"},
        {"run -", "<&-", "stdin: cannot be read: Bad file descriptor"},
    };
    char path[PROGRAM_PATH_SIZE];
    program_path(program, ".errors", path);
    for (size_t i = 0; i < sizeof ASKED / sizeof *ASKED; i++) {
        assert_int_equal(run_closed(program, ASKED[i].words, ASKED[i].closed), 5);
        program_read(path, program->errors);
        assert_says(program->errors, ASKED[i].message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define CLOSED_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)
        CLOSED_TEST(a_study_keeps_its_store),
        CLOSED_TEST(a_comparison_keeps_its_store),
        CLOSED_TEST(a_closed_stream_is_of_no_use_still),
#undef CLOSED_TEST
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Do the commands that the program prints do what they say, whatever a file is called, and nothing
// else?
#include "program.h"

#include <sys/stat.h>

// Names that would run `touch broken`, end a comment or a string, or be taken for an option. In the
// code that tune writes they stand in comments.
static const char *const NAMES[] = {
    "plain.yaml",
    "two words.yaml",
    "c'; touch broken; '.yaml",
    "$(touch broken)`touch broken`.yaml",
    "*\\ \"what?\?\\.yaml",
    "ends in \\",
    "folder?\?/case.yaml",
    "-h.yaml",
    "--set",
    "a\nint broken;\n'; touch broken; '.yaml",
    "\x1b[31m\xe2\x80\xae \xff.yaml",
    "a --set b.yaml",
};
enum { NAME_COUNT = sizeof NAMES / sizeof *NAMES };

static const char TITLE[] = "it's \"*/\" ?\?/ \\";

static const char CASE[] = "bodies:\n"
                           "  arm: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [10 mm, 0 mm]}\n"
                           "joints:\n"
                           "  hinge: {between: [ground, arm], at: [0 mm, 0 mm]}\n"
                           "run: {duration: 60 ms, samples: 10, step: 100 us,\n"
                           "      backends: [reference, ode]}\n";

static void write_case(const Program *program, const char *name)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "folder?\?", path);
    mkdir(path, 0700);
    program_path(program, name, path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs(CASE, stream);
    assert_int_equal(fclose(stream), 0);
    setenv("NAME", name, 1);
    setenv("TITLE", TITLE, 1);
}

// Runs what was printed as a shell of the user's would, and keeps the hash of the run of ODE.
static void run_printed(Program *program, const char *command, char hash[32])
{
    char line[4 * PROGRAM_PATH_SIZE];
    setenv("PRINTED", command, 1);
    snprintf(line, sizeof line,
             "cd '%s' && mkdir -p .bin && ln -sf \"$JOINTPLAY_PROGRAM\" .bin/jointplay && "
             "PATH=$PWD/.bin:$PATH sh -c \"$PRINTED --json --quiet\" >.output 2>.errors",
             program->folder);
    const int status = system(line);
    char path[PROGRAM_PATH_SIZE];
    program_path(program, ".errors", path);
    program_read(path, program->errors);
    if (status != 0) {
        fail_msg("%s: %s", command, program->errors);
    }
    program_path(program, ".output", path);
    program_read(path, program->output);
    json_t *root = program_json(program);
    assert_string_equal(json_string_value(json_object_get(root, "title")), TITLE);
    const json_t *runs = json_object_get(root, "runs");
    const json_t *run = json_array_get(runs, json_array_size(runs) - 1);
    snprintf(hash, 32, "%s", json_string_value(json_object_get(run, "hash")));
    json_decref(root);
}

// What stands between two marks, without the first.
static char *cut_out(const char *text, const char *from, const char *to)
{
    const char *start = strstr(text, from);
    assert_non_null(start);
    start += strlen(from);
    const char *end = strstr(start, to);
    assert_non_null(end);
    return strndup(start, (size_t)(end - start));
}

static const char TUNE[] = "tune --full --error 0.1 --schemes direct/plain --cost steps --quiet "
                           "--set \"title=$TITLE\" --code code.c";

static void what_tune_prints_runs_the_same_case_and_nothing_else(void **state)
{
    Program *program = *state;
    char words[PROGRAM_PATH_SIZE];
    char path[PROGRAM_PATH_SIZE];
    char hash[32];
    for (int i = 0; i < NAME_COUNT; i++) {
        write_case(program, NAMES[i]);
        snprintf(words, sizeof words, "%s --json -- \"$NAME\"", TUNE);
        program_run(program, words);
        assert_int_equal(program->status, 0);
        json_t *root = program_json(program);
        const json_t *cheapest = json_object_get(root, "cheapest");
        const char *wanted = json_string_value(json_object_get(cheapest, "hash"));
        run_printed(program, json_string_value(json_object_get(cheapest, "command")), hash);
        assert_string_equal(hash, wanted);
        // in the code's comments
        program_path(program, "code.c", path);
        program_read(path, program->output);
        char *command = cut_out(program->output, "\n// same as  ", "\n");
        run_printed(program, command, hash);
        assert_string_equal(hash, wanted);
        free(command);
        snprintf(words, sizeof words,
                 "cd '%s' && $JOINTPLAY_CC -trigraphs -Wall -Werror -fsyntax-only "
                 "-I\"$JOINTPLAY_HEADERS\" code.c",
                 program->folder);
        assert_int_equal(system(words), 0);
        // in the tables, a setting a line
        snprintf(words, sizeof words, "%s -- \"$NAME\"", TUNE);
        program_run(program, words);
        assert_int_equal(program->status, 0);
        command = cut_out(program->output, "\n  run it\n    ", "'\n");
        snprintf(words, sizeof words, "%s'", command);
        run_printed(program, words, hash);
        assert_string_equal(hash, wanted);
        free(command);
        json_decref(root);
        program_path(program, "broken", path);
        assert_int_equal(access(path, F_OK), -1);
    }
}

static void a_message_names_a_command_that_can_be_copied(void **state)
{
    Program *program = *state;
    write_case(program, "-h x.yaml");
    program_fails_usage(program, "tune -- \"$NAME\"", "jointplay tune './-h x.yaml' --error 1e-3");
    program_fails_usage(program, "study -- \"$NAME\"", "allowed: jointplay run './-h x.yaml'");
    program_fails_usage(program, "map --stiffness \"1e9'\" -- \"$NAME\"",
                        "--set 'contact.stiffness=1e9'\"'\"''");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_tune_prints_runs_the_same_case_and_nothing_else,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(a_message_names_a_command_that_can_be_copied,
                                        program_set_up, program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

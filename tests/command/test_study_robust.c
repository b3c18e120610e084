// Does a study lose nothing, and make nothing twice, whatever is done to it?
#define _GNU_SOURCE // memmem

#include "program.h"

#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <time.h>

enum { WORDS_SIZE = 128, LINE_MAX_COUNT = 256, CHILD_WAIT = 500, KILLS = 8 };

// A study of nine runs a step, some 10 ms each, and of three truths, in the program's folder.
static const char STUDY[] = "title: A study to be hurt\n"
                            "case: %s/paper/ideal-nominal.yaml\n"
                            "set: {run.samples: 360, run.revolutions: %s}\n"
                            "vary:\n"
                            "  drive.speed: [%s rpm, 1000 rpm, 1500 rpm]\n"
                            "  scheme: [direct/plain, direct/staggered, direct/extrapolated]\n"
                            "  run.step: [%s]\n"
                            "truth: %s\n"
                            "limits: {time: 60 s}\n";

static const char FOUR_STEPS[] = "10 us, 20 us, 30 us, 40 us";

static void write_study(const Program *program, const char *revolutions, const char *speed,
                        const char *steps, const char *truth)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "s.yaml", path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream, STUDY, getenv("JOINTPLAY_CASES"), revolutions, speed, steps, truth);
    fclose(stream);
}

static void run_well(Program *program, const char *words)
{
    program_run(program, words);
    if (program->status != 0) {
        fail_msg("%s: status %d: %s", words, program->status, program->errors);
    }
}

static void rest(double seconds)
{
    const struct timespec time = {(time_t)seconds,
                                  (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&time, NULL);
}

// Starts a study in the program's folder, quietly.
static pid_t start(const Program *program, const char *store, const char *jobs)
{
    const pid_t process = fork();
    if (process == 0) {
        const int nowhere = open("/dev/null", O_WRONLY);
        dup2(nowhere, STDOUT_FILENO);
        dup2(nowhere, STDERR_FILENO);
        if (chdir(program->folder) == 0) {
            execl(getenv("JOINTPLAY_PROGRAM"), "jointplay", "study", "s.yaml", "--store", store,
                  "--jobs", jobs, (char *)NULL);
        }
        _exit(127);
    }
    return process;
}

// The rows of a store without what is never twice the same, the last column.
static size_t read_rows(Program *program, const char *store, char lines[][PROGRAM_PATH_SIZE])
{
    char words[WORDS_SIZE];
    snprintf(words, sizeof words, "study export %s", store);
    run_well(program, words);
    size_t count = 0;
    char *line = strtok(program->output, "\n");
    assert_non_null(line);
    assert_non_null(strstr(line, ",wall_s"));
    while ((line = strtok(NULL, "\n")) != NULL) {
        assert_true(count < LINE_MAX_COUNT);
        char *comma = strrchr(line, ',');
        assert_non_null(comma);
        *comma = '\0';
        snprintf(lines[count++], PROGRAM_PATH_SIZE, "%s", line);
    }
    return count;
}

typedef char Line[PROGRAM_PATH_SIZE];

static void check_same_rows(Program *program, const char *one, const char *other)
{
    Line *rows = calloc(2 * LINE_MAX_COUNT, sizeof *rows);
    Line *others = rows + LINE_MAX_COUNT;
    const size_t count = read_rows(program, one, rows);
    assert_int_equal(read_rows(program, other, others), count);
    for (size_t i = 0; i < count; i++) {
        assert_string_equal(rows[i], others[i]);
    }
    free(rows);
}

// Every row of before is there still, as it was.
static size_t check_kept_rows(Program *program, const char *store, Line *before, size_t count)
{
    Line *now = calloc(LINE_MAX_COUNT, sizeof *now);
    const size_t now_count = read_rows(program, store, now);
    size_t k = 0;
    for (size_t i = 0; i < count; i++) {
        while (k < now_count && strcmp(now[k], before[i]) != 0) {
            k++;
        }
        if (k == now_count) {
            fail_msg("lost or changed: %s", before[i]);
        }
    }
    memcpy(before, now, LINE_MAX_COUNT * sizeof *now);
    free(now);
    return now_count;
}

static bool is_there(const Program *program, const char *name)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    return access(path, F_OK) == 0;
}

static void killing_it_at_any_moment_loses_nothing_and_makes_nothing_twice(void **state)
{
    Program *program = *state;
    Line *rows = calloc(LINE_MAX_COUNT, sizeof *rows);
    size_t count = 0;
    write_study(program, "4", "500", FOUR_STEPS, "true");
    unsigned seed = 5;
    for (int i = 0; i < KILLS; i++) {
        const pid_t process = start(program, "killed.sqlite", "2");
        // from before the first row to well after some
        rest(0.2 * (double)rand_r(&seed) / RAND_MAX);
        kill(process, SIGKILL);
        waitpid(process, NULL, 0);
        if (is_there(program, "killed.sqlite")) {
            // where it was killed while the tables were made there is no store yet
            program_run(program, "study status killed.sqlite");
            count = program->status == 0 ? check_kept_rows(program, "killed.sqlite", rows, count)
                                         : count;
        }
    }
    run_well(program, "study s.yaml --store killed.sqlite");
    assert_int_equal(check_kept_rows(program, "killed.sqlite", rows, count), 36);
    run_well(program, "study s.yaml --store once.sqlite");
    check_same_rows(program, "killed.sqlite", "once.sqlite");
    free(rows);
}

// A child of a process, waited for.
static pid_t find_child(pid_t process)
{
    char path[WORDS_SIZE];
    snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)process, (int)process);
    for (int i = 0; i < CHILD_WAIT; i++) {
        int child = 0;
        FILE *stream = fopen(path, "r");
        const bool is_found = stream != NULL && fscanf(stream, "%d", &child) == 1;
        if (stream != NULL) {
            fclose(stream);
        }
        if (is_found) {
            return child;
        }
        rest(0.01);
    }
    fail_msg("%s names no child", path);
    return 0;
}

static void a_killed_child_is_one_row_and_is_made_again_when_asked_for(void **state)
{
    Program *program = *state;
    write_study(program, "8", "500", "20 us", "false");
    const pid_t process = start(program, "s.sqlite", "1");
    kill(find_child(process), SIGKILL);
    int status;
    waitpid(process, &status, 0);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    run_well(program, "study export s.yaml");
    const char *row = strstr(program->output, "ended by signal 9 (Killed)");
    assert_non_null(row);
    assert_null(strstr(row + 1, "ended by signal"));
    run_well(program, "study s.yaml --retry-failed --json");
    json_t *root = program_json(program);
    assert_int_equal(json_integer_value(json_object_get(json_object_get(root, "now"), "made")), 1);
    assert_int_equal(json_integer_value(json_object_get(json_object_get(root, "outcomes"), "ok")),
                     9);
    json_decref(root);
    run_well(program, "study s.yaml --store once.sqlite");
    check_same_rows(program, "s.sqlite", "once.sqlite");
}

static void shards_merge_to_what_one_store_holds(void **state)
{
    Program *program = *state;
    write_study(program, "1", "500", FOUR_STEPS, "true");
    program_run(program, "study merge s.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "there are no parts of s.yaml in the working folder");
    run_well(program, "study s.yaml --shard 1/3");
    run_well(program, "study s.yaml --shard 3/3 --jobs 1");
    program_run(program, "study merge s.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "there is no s.2-of-3.sqlite beside the other parts");
    assert_false(is_there(program, "s.sqlite"));
    run_well(program, "study s.yaml --shard 2/3");
    run_well(program, "study merge s.yaml");
    assert_says(program->errors, "which holds 36 of 36");
    run_well(program, "study s.yaml --store once.sqlite --quiet");
    assert_string_equal(program->errors, "");
    check_same_rows(program, "s.sqlite", "once.sqlite");
    // a second time adds nothing, and the study has nothing left to do
    run_well(program, "study merge s.yaml");
    assert_says(program->errors, "merged 0 runs");
    run_well(program, "study s.yaml");
    assert_says(program->output, "Nothing was left to run; the runs are kept in s.sqlite.");
}

static void a_second_process_is_told_that_the_store_is_at_work(void **state)
{
    Program *program = *state;
    write_study(program, "100", "500", FOUR_STEPS, "false");
    const pid_t process = start(program, "s.sqlite", "1");
    find_child(process);
    program_run(program, "study s.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "s.sqlite is in use by another process");
    // looking at it is no harm
    run_well(program, "study status s.yaml");
    // told to stop, it does so in good order
    kill(process, SIGTERM);
    int status;
    waitpid(process, &status, 0);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    run_well(program, "study status s.yaml");
}

static void another_study_does_not_mix_with_it(void **state)
{
    Program *program = *state;
    write_study(program, "1", "500", FOUR_STEPS, "false");
    run_well(program, "study s.yaml");
    write_study(program, "1", "501", FOUR_STEPS, "false");
    program_run(program, "study s.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "the study file or its case has changed");
    assert_says(program->errors, "--fresh");
    run_well(program, "study s.yaml --fresh --json");
    json_t *root = program_json(program);
    assert_int_equal(json_integer_value(json_object_get(json_object_get(root, "now"), "made")), 36);
    json_decref(root);
}

// The value of a column in the first row.
static double first_value(const char *csv, const char *column)
{
    const char *name = csv;
    const char *value = strchr(csv, '\n') + 1;
    while (strncmp(name, column, strlen(column)) != 0) {
        name = strchr(name, ',') + 1;
        value = strchr(value, ',') + 1;
    }
    return strtod(value, NULL);
}

// Turns one bit of a number where it stands in a file, as SQLite writes it.
static void turn_bit(const Program *program, const char *name, double value)
{
    char path[PROGRAM_PATH_SIZE];
    static unsigned char content[1 << 18];
    unsigned char bytes[sizeof value];
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (size_t i = 0; i < sizeof bytes; i++) {
        bytes[i] = (unsigned char)(bits >> 8 * (sizeof bytes - 1 - i));
    }
    program_path(program, name, path);
    FILE *stream = fopen(path, "r+b");
    assert_non_null(stream);
    const size_t size = fread(content, 1, sizeof content, stream);
    unsigned char *place = memmem(content, size, bytes, sizeof bytes);
    assert_non_null(place);
    place[1] ^= 0x80;
    assert_int_equal(fseek(stream, place - content, SEEK_SET), 0);
    fwrite(place, 1, sizeof bytes, stream);
    assert_int_equal(fclose(stream), 0);
}

static void a_bit_that_turned_is_told_by_every_command(void **state)
{
    Program *program = *state;
    static const char *const READERS[] = {
        "study s.yaml", "study status s.yaml", "study export s.yaml",
        "study plot s.sqlite --x drive_speed_rad_s --y coupler_alpha_max_rad_s2 p.svg",
        "study merge m.sqlite s.sqlite"};
    write_study(program, "1", "500", FOUR_STEPS, "false");
    run_well(program, "study s.yaml --store once.sqlite");
    run_well(program, "study s.yaml");
    run_well(program, "study export s.yaml");
    turn_bit(program, "s.sqlite", first_value(program->output, "coupler_alpha_max_rad_s2"));
    for (size_t i = 0; i < sizeof READERS / sizeof *READERS; i++) {
        program_run(program, READERS[i]);
        assert_int_equal(program->status, 5);
        assert_says(program->errors,
                    "the store s.sqlite is damaged: run 0 does not match its "
                    "checksum; 'jointplay study FILE --retry-failed' makes it again");
    }
    assert_false(is_there(program, "m.sqlite") || is_there(program, "p.svg"));
    run_well(program, "study s.yaml --retry-failed");
    assert_says(program->errors, "making 1 failed or damaged runs again");
    check_same_rows(program, "s.sqlite", "once.sqlite");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define ROBUST_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)
        ROBUST_TEST(killing_it_at_any_moment_loses_nothing_and_makes_nothing_twice),
        ROBUST_TEST(a_killed_child_is_one_row_and_is_made_again_when_asked_for),
        ROBUST_TEST(shards_merge_to_what_one_store_holds),
        ROBUST_TEST(a_second_process_is_told_that_the_store_is_at_work),
        ROBUST_TEST(another_study_does_not_mix_with_it),
        ROBUST_TEST(a_bit_that_turned_is_told_by_every_command),
#undef ROBUST_TEST
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

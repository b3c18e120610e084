// Does `jointplay compare` print, write and end as it should, and lose nothing when it is killed?
#include "program.h"

#include <signal.h>
#include <time.h>
#include <unistd.h>

// a part of a turn is as good as all of it
#define PART "run.revolutions=0.1"
static const char CHEAP[] = "compare --full $cases/paper/ideal-nominal.yaml --store s.jsonl "
                            "--steps '100 us, 30us, 50 us' --set " PART " ";

static const json_t *find_scheme(const json_t *root, const char *name)
{
    const json_t *schemes = json_object_get(root, "schemes");
    for (size_t i = 0; i < json_array_size(schemes); i++) {
        const json_t *scheme = json_array_get(schemes, i);
        if (strcmp(json_string_value(json_object_get(scheme, "scheme")), name) == 0) {
            return scheme;
        }
    }
    fail_msg("no scheme %s", name);
    return NULL;
}

static double number(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

// The runs of a comparison: each point an error run and the timing runs.
static size_t count_most_runs(const json_t *root)
{
    size_t points = 0;
    const json_t *schemes = json_object_get(root, "schemes");
    for (size_t i = 0; i < json_array_size(schemes); i++) {
        points += json_array_size(json_object_get(json_array_get(schemes, i), "points"));
    }
    return points * (1 + (size_t)number(root, "repeats"));
}

static size_t count_lines(const Program *program, const char *name)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "r");
    size_t lines = 0;
    for (int c = 0; stream != NULL && (c = fgetc(stream)) != EOF;) {
        lines += c == '\n' ? 1 : 0;
    }
    if (stream != NULL) {
        fclose(stream);
    }
    return lines;
}

static void run_words(Program *program, const char *more)
{
    char words[PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "%s%s", CHEAP, more);
    program_run(program, words);
}

// A comparison that is complete, made once for all tests that begin where one is.
static int make_store(void **state)
{
    const int status = program_set_up(state);
    run_words(*state, "-q");
    return status != 0 || ((Program *)*state)->status != 0 ? -1 : 0;
}

static int set_up_with_store(void **state)
{
    const Program *made = *state;
    char command[3 * PROGRAM_PATH_SIZE];
    const int status = program_set_up(state);
    snprintf(command, sizeof command, "cp '%s/s.jsonl' '%s'", made->folder,
             ((Program *)*state)->folder);
    return status != 0 ? status : system(command);
}

static void points_orders_and_the_cheapest_are_printed(void **state)
{
    Program *program = *state;
    run_words(program, "");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Speed against error");
    assert_says(program->output, "direct/plain");
    assert_says(program->output, "Order observed");
    assert_says(program->output, "Cheapest setting of ODE");
    assert_says(program->output, "auto/1e-6");
    assert_null(strchr(program->output, '\x1b'));
    // lines of progress at most
    assert_null(strstr(program->errors, "jointplay:"));
}

static void json_holds_every_point(void **state)
{
    Program *program = *state;
    run_words(program, "--json -q");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *direct = find_scheme(root, "direct/plain");
    const json_t *points = json_object_get(direct, "points");
    assert_int_equal(json_array_size(points), 3);
    // coarse to fine, in whatever order they were given
    assert_near(number(json_array_get(points, 0), "step_s"), 1e-4, 1e-18);
    assert_near(number(json_array_get(points, 2), "step_s"), 3e-5, 1e-18);
    for (size_t i = 0; i < 3; i++) {
        const json_t *point = json_array_get(points, i);
        assert_string_equal(json_string_value(json_object_get(point, "status")), "ok");
        // a point that another beats in both may be timed once
        const size_t timed = json_array_size(json_object_get(point, "wall_s"));
        const bool is_best = json_is_true(json_object_get(point, "on_frontier"));
        assert_true(timed == 5 || (timed == 1 && !is_best));
        assert_true(number(point, "wall_min_s") <= number(point, "wall_median_s"));
        assert_true(number(point, "wall_median_s") <= number(point, "wall_max_s"));
    }
    // first order against the closed form, some 82 rad/s^2 .. of error a second of step
    assert_near(number(json_object_get(direct, "order"), "order"), 1.0, 0.05);
    assert_near(number(json_array_get(points, 0), "error_max"), 8.2e-3, 1e-3);
    assert_non_null(find_scheme(root, "analytic"));
    assert_string_equal(
        json_string_value(json_object_get(json_object_get(root, "truth"), "backend")), "analytic");
    json_decref(root);
}

// Starts the program by itself in its folder.
static pid_t start(const Program *program, const char *steps)
{
    const pid_t process = fork();
    if (process == 0) {
        char word[PROGRAM_PATH_SIZE];
        snprintf(word, sizeof word, "%s/paper/ideal-nominal.yaml", getenv("JOINTPLAY_CASES"));
        signal(SIGINT, SIG_DFL);
        if (chdir(program->folder) == 0 && freopen(".output", "w", stdout) != NULL &&
            freopen(".errors", "w", stderr) != NULL) {
            execl(getenv("JOINTPLAY_PROGRAM"), "jointplay", "compare", word, "--store", "s.jsonl",
                  "--steps", steps, "--set", PART, (char *)NULL);
        }
        _exit(127);
    }
    return process;
}

// Starts it and ends it after so many seconds, as the worst of users would.
static void kill_after(const Program *program, double seconds)
{
    const pid_t process = start(program, "100 us, 30us, 50 us");
    const struct timespec pause = {0, (long)(1e9 * seconds)};
    nanosleep(&pause, NULL);
    kill(process, SIGKILL);
    waitpid(process, NULL, 0);
}

static void killing_it_at_any_moment_loses_nothing(void **state)
{
    Program *program = *state;
    const double moments[] = {0.001, 0.01, 0.02, 0.03, 0.05, 0.1};
    size_t lines = 0;
    for (int i = 0; i < 6; i++) {
        kill_after(program, moments[i]);
        // what had been finished stays
        assert_true(count_lines(program, "s.jsonl") >= lines);
        lines = count_lines(program, "s.jsonl");
    }
    run_words(program, "--json");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    // behind the key and the truth a line a run: at the most an error run of each point, and all
    // its timing runs
    const size_t runs = count_lines(program, "s.jsonl") - 2;
    const size_t most = count_most_runs(root);
    assert_true(runs <= most && runs >= most / 3);
    if (lines > 2) {
        char words[128];
        snprintf(words, sizeof words, "took %zu runs from the store s.jsonl; ", lines - 2);
        assert_says(program->errors, words);
    }
    json_decref(root);
    // once more: everything is there, and nothing is run
    run_words(program, "--json");
    char words[128];
    snprintf(words, sizeof words, "took %zu runs from the store s.jsonl; 0 are left", runs);
    assert_says(program->errors, words);
    assert_int_equal(count_lines(program, "s.jsonl"), runs + 2);
    // more repeats only add to it
    run_words(program, "--json --repeats 6");
    assert_says(program->errors, "took ");
    const size_t added = count_lines(program, "s.jsonl") - 2 - runs;
    assert_true(added > 0 && added <= most / 6);
}

static void told_to_stop_it_says_what_is_kept_and_ends_by_the_signal(void **state)
{
    Program *program = *state;
    const pid_t process = start(program, "100 us, 0.001 us"); // minutes
    while (count_lines(program, "s.jsonl") < 4 && waitpid(process, NULL, WNOHANG) == 0) {
        usleep(5000);
    }
    kill(process, SIGINT);
    int status = 0;
    waitpid(process, &status, 0);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
    char path[PROGRAM_PATH_SIZE];
    program_path(program, ".errors", path);
    program_read(path, program->errors);
    char words[128];
    snprintf(words, sizeof words, "stopped; %zu of ", count_lines(program, "s.jsonl") - 2);
    assert_says(program->errors, words);
    assert_says(program->errors, "kept in s.jsonl, and the same command goes on from there");
}

static void a_store_of_another_comparison_is_refused(void **state)
{
    Program *program = *state;
    run_words(program, "--set run.samples=100");
    assert_int_equal(program->status, 5);
    assert_string_equal(program->output, "");
    assert_says(program->errors, "settings.run.samples is 3600 there and 100 here");
    run_words(program, "--set run.samples=100 --schemes direct/plain --fresh");
    assert_int_equal(program->status, 0);
    assert_null(strstr(program->errors, "took"));
}

// The error of the scheme direct/plain at the first step.
static double error_of(const Program *program)
{
    json_t *root = program_json(program);
    const json_t *points = json_object_get(find_scheme(root, "direct/plain"), "points");
    const double error = number(json_array_get(points, 0), "error_max");
    json_decref(root);
    return error;
}

// Puts another digit in the place of the first one of the error of the first run; its line.
static size_t damage_error(const Program *program)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "s.jsonl", path);
    static char content[PROGRAM_OUTPUT_SIZE];
    program_read(path, content);
    char *place = strstr(content, "\"scheme\":\"direct/plain\"");
    while (place > content && place[-1] != '\n') {
        place--;
    }
    size_t line = 1;
    for (const char *c = content; c < place; c++) {
        line += *c == '\n' ? 1 : 0;
    }
    place = strstr(place, "\"omega_max\":");
    assert_non_null(place);
    place += strlen("\"omega_max\":");
    *place = *place == '3' ? '4' : '3';
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs(content, stream);
    fclose(stream);
    return line;
}

static void a_line_of_the_store_that_was_changed_is_told_and_not_used(void **state)
{
    Program *program = *state;
    run_words(program, "-q --json");
    const double error = error_of(program);
    const size_t lines = count_lines(program, "s.jsonl");
    const size_t damaged = damage_error(program);
    run_words(program, "--json");
    assert_int_equal(program->status, 0);
    char words[128];
    snprintf(words, sizeof words,
             "line %zu of the store s.jsonl is damaged and not used; its run is repeated", damaged);
    assert_says(program->errors, words);
    assert_near(error_of(program), error, 0.0);
    assert_int_equal(count_lines(program, "s.jsonl"), lines + 1);
}

static void a_case_whose_only_body_is_driven_is_refused(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "wheel.yaml", path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs("bodies:\n  wheel: {mass: 1 kg, inertia: 1e-3 kg m^2, at: [0 m, 0 m]}\n"
          "joints:\n  axle: {between: [ground, wheel], at: [0 m, 0 m]}\n"
          "drive: {joint: axle, speed: 100 rpm}\n"
          "run: {backends: [reference, ode]}\n",
          stream);
    fclose(stream);
    program_run(program, "compare wheel.yaml --store s.jsonl");
    assert_int_equal(program->status, 3);
    assert_says(program->errors, "there is nothing to compare: the drive prescribes how 'wheel'");
    assert_int_equal(count_lines(program, "s.jsonl"), 0);
}

static void the_usual_store_is_found_by_its_key(void **state)
{
    Program *program = *state;
    char words[PROGRAM_PATH_SIZE];
    setenv("XDG_CACHE_HOME", program->folder, 1);
    static const char LINE[] = "compare --full $cases/paper/ideal-nominal.yaml --steps '100us' "
                               "--schemes direct --jobs 2 %s";
    snprintf(words, sizeof words, LINE, "");
    program_run(program, words);
    assert_int_equal(program->status, 0);
    assert_null(strstr(program->errors, "took"));
    program_run(program, words);
    assert_says(program->errors, "/jointplay/compare-");
    assert_says(program->errors, "took ");
    // another key has another store, and the first is still there
    snprintf(words, sizeof words, LINE, "--set run.samples=360");
    program_run(program, words);
    assert_int_equal(program->status, 0);
    assert_null(strstr(program->errors, "took"));
    setenv("XDG_CACHE_HOME", "", 1);
    setenv("HOME", program->folder, 1);
    program_run(program, words);
    assert_int_equal(program->status, 0);
    snprintf(words, sizeof words, "%s/.cache/jointplay", program->folder);
    assert_int_equal(access(words, F_OK), 0);
    setenv("HOME", "", 1);
    snprintf(words, sizeof words, LINE, "");
    program_fails_usage(program, words, "there is no folder for the store");
}

static void files_are_written(void **state)
{
    Program *program = *state;
    static const char *const NAMES[] = {"p.svg",
                                        "p.csv",
                                        "out/ideal-nominal-compare.txt",
                                        "out/ideal-nominal-compare.csv",
                                        "out/ideal-nominal-compare.svg",
                                        "out/ideal-nominal-compare.json"};
    run_words(program, "--plot p.svg --csv p.csv --out out");
    assert_int_equal(program->status, 0);
    for (int i = 0; i < 6; i++) {
        char path[PROGRAM_PATH_SIZE];
        program_path(program, NAMES[i], path);
        assert_int_equal(access(path, F_OK), 0);
        assert_says(program->errors, NAMES[i]);
    }
    run_words(program, "--plot nowhere/p.svg");
    assert_int_equal(program->status, 5);
    assert_string_equal(program->output, "");
    run_words(program, "--csv nowhere/p.csv");
    assert_int_equal(program->status, 5);
    assert_string_equal(program->output, "");
    run_words(program, "--out p.csv/x");
    assert_int_equal(program->status, 5);
}

static void when_every_run_of_ode_fails_the_status_is_4(void **state)
{
    Program *program = *state;
    // the truth is kept, so that only ODE's runs are cut short
    program_run(program, "compare $cases/paper/ideal-nominal.yaml --steps 50us --schemes direct "
                         "--store s.jsonl --set run.revolutions=4 -q");
    assert_int_equal(program->status, 0);
    program_run(program, "compare $cases/paper/ideal-nominal.yaml --steps 50us --schemes direct "
                         "--store s.jsonl --set run.revolutions=4 --repeats 6 --time-limit 1us");
    assert_int_equal(program->status, 4);
    assert_says(program->errors, "every run of ODE failed: direct/plain at 50 us");
    assert_says(program->errors, "took longer than its limit");
    // a run that was cut short is tried again
    program_run(program, "compare $cases/paper/ideal-nominal.yaml --steps 50us --schemes direct "
                         "--store s.jsonl --set run.revolutions=4 --repeats 6 -q");
    assert_int_equal(program->status, 0);
}

static void a_collider_is_a_part_of_the_scheme(void **state)
{
    Program *program = *state;
    static const char CASE[] =
        "compare --full $cases/paper/impact-k66.yaml --set run.revolutions=0.02 "
        "--steps 10us -q --json --fresh --store colliders.jsonl ";
    char words[PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "%s%s", CASE,
             "--schemes direct/plain/textbook,direct/plain/textbook/staves");
    program_run(program, words);
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const char *const NAMES[] = {"direct/plain/textbook", "direct/plain/textbook/staves"};
    const char *const COLLIDERS[] = {"pin-hole", "staves"};
    double errors[2];
    for (int i = 0; i < 2; i++) {
        const json_t *scheme = find_scheme(root, NAMES[i]);
        assert_string_equal(json_string_value(json_object_get(scheme, "collider")), COLLIDERS[i]);
        const json_t *points = json_object_get(scheme, "points");
        errors[i] = number(json_array_get(points, 0), "error_max");
    }
    assert_true(errors[0] > 0.0 && errors[1] > 0.0 && errors[0] != errors[1]);
    json_decref(root);
    // what cannot be resolved fails with the reason
    snprintf(words, sizeof words, "%s%s", CASE,
             "--schemes direct/plain/textbook/ode-convex "
             "--set 'joints.crank-coupler.radial-clearance=2.5 um'");
    program_run(program, words);
    assert_int_equal(program->status, 4);
    assert_says(program->errors, "collider ode-convex resolves 1 um");
}

static void a_wrong_command_line_is_answered(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "compare", "no case given");
    program_fails_usage(program, "compare a.yaml b.yaml", "compare takes one case");
    program_fails_usage(program, "compare a.yaml --repeats 4", "a whole number from 5 to 100");
    program_fails_usage(program, "compare a.yaml --jobs 0", "--jobs is 0");
    program_fails_usage(program, "compare a.yaml --csv x --plot x", "would both write x");
    program_fails_usage(program, "compare a.yaml --time-limit 5kg", "--time-limit");
    program_fails_usage(program, "compare a.yaml --time-limit '-1 s'", "--time-limit");
    program_fails_usage(program, "compare a.yaml --stepps 1us", "did you mean '--steps'?");
    program_fails_usage(program, "compare $cases/paper/ideal-nominal.yaml --steps ''", "is empty");
    program_fails_usage(program, "compare $cases/paper/ideal-nominal.yaml --steps '1us, 1 us'",
                        "1 us is given twice");
    program_fails_usage(program, "compare $cases/paper/ideal-nominal.yaml --steps '1us, 2'",
                        "--steps");
    program_fails_usage(program, "compare $cases/paper/ideal-nominal.yaml --steps '1 s'", "step");
    program_fails_usage(program, "compare $cases/paper/ideal-nominal.yaml --schemes drect",
                        "no scheme of this case is 'drect'");
    program_run(program, "compare nowhere.yaml");
    assert_int_equal(program->status, 5);
    // the quick solver makes use of the seed; without play nothing makes use of the law
    program_run(program, "compare $cases/paper/ideal-nominal.yaml --store s.jsonl --steps 100us "
                         "--set contact.law=johnson --set ode.seed=4");
    assert_int_equal(program->status, 0);
    assert_says(program->errors, "contact.law of the command line has no effect here; it would ");
    assert_null(strstr(program->errors, "ode.seed"));
    program_run(program, "compare --help");
    assert_int_equal(program->status, 0);
    assert_says(program->output, "Usage: jointplay compare [OPTION...] CASE");
    assert_says(program->output, "(default: one per core)");
}

#define COMPARE_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)
#define STORE_TEST(name)   cmocka_unit_test_setup_teardown(name, set_up_with_store, program_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        COMPARE_TEST(points_orders_and_the_cheapest_are_printed),
        STORE_TEST(json_holds_every_point),
        COMPARE_TEST(killing_it_at_any_moment_loses_nothing),
        COMPARE_TEST(told_to_stop_it_says_what_is_kept_and_ends_by_the_signal),
        STORE_TEST(a_store_of_another_comparison_is_refused),
        COMPARE_TEST(a_line_of_the_store_that_was_changed_is_told_and_not_used),
        COMPARE_TEST(a_case_whose_only_body_is_driven_is_refused),
        COMPARE_TEST(the_usual_store_is_found_by_its_key),
        STORE_TEST(files_are_written),
        COMPARE_TEST(when_every_run_of_ode_fails_the_status_is_4),
        COMPARE_TEST(a_collider_is_a_part_of_the_scheme),
        COMPARE_TEST(a_wrong_command_line_is_answered),
    };
    return cmocka_run_group_tests(tests, make_store, program_tear_down);
}

// Does a study whose runs begin in the settled motion of a neighbour have the rows of one in which
// each finds its own, in whatever parts it is made, and does it leave that where there is no one
// motion to come to?
#include "program.h"

#include <math.h>
#include <stdlib.h>

// The feeder of the tutorial: one motion at each speed.
static const char FEEDER[] =
    "four-bar:\n"
    "  ground: {length: 210 mm}\n"
    "  crank: {length: 40 mm, mass: 90 g, inertia: 12 kg mm^2}\n"
    "  coupler: {length: 200 mm, mass: 180 g, inertia: 600 kg mm^2}\n"
    "  follower: {length: 90 mm, mass: 400 g, inertia: 2500 kg mm^2}\n"
    "joints: {coupler-follower: {hole: 10.08 mm, pin: 10 mm}}\n"
    "drive: {speed: 300 rpm}\n"
    "contact: {law: hertz-socket, damping: exact, restitution: 0.5, friction: 0.1}\n"
    "run: {revolutions: 1, samples: 36}\n";

// A ball joint of much play, which does not repeat.
static const char LOOSE[] = "slider-crank:\n"
                            "  crank: {length: 50 mm, mass: 0.3 kg, inertia: 100 kg mm^2}\n"
                            "  rod: {length: 120 mm, mass: 0.21 kg, inertia: 250 kg mm^2}\n"
                            "  slider: {mass: 0.14 kg, inertia: 100 kg mm^2}\n"
                            "joints: {rod-slider: {hole: 20.4 mm, pin: 20 mm}}\n"
                            "drive: {speed: 600 rpm}\n"
                            "contact: {restitution: 0.7}\n"
                            "run: {revolutions: 1, samples: 36, settle-starts: 4}\n";

static void write_text(const Program *program, const char *name, const char *text)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs(text, stream);
    assert_int_equal(fclose(stream), 0);
}

static void run_well(Program *program, const char *words)
{
    program_run(program, words);
    if (program->status != 0) {
        fail_msg("%s: status %d: %s", words, program->status, program->errors);
    }
}

enum { RUNS = 6, ROWS_SIZE = 1 << 16 };

// A column of the rows of a store, NAN where a cell is empty; false where there is no such column.
static bool read_column(Program *program, const char *store, const char *name, double values[RUNS])
{
    char words[PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "study export %s", store);
    run_well(program, words);
    char *rows = program->output;
    int column = -1;
    char *head = strsep(&rows, "\n");
    for (int i = 0; head != NULL && column < 0; i++) {
        column = strcmp(strsep(&head, ","), name) == 0 ? i : -1;
    }
    for (int run = 0; run < RUNS && column >= 0; run++) {
        char *row = strsep(&rows, "\n");
        assert_non_null(row);
        for (int i = 0; i < column; i++) {
            strsep(&row, ",");
        }
        values[run] = *row == ',' ? NAN : strtod(row, NULL);
    }
    return column >= 0;
}

static size_t count_of(const double values[RUNS])
{
    size_t count = 0;
    for (int run = 0; run < RUNS; run++) {
        count += isnan(values[run]) ? 0 : 1;
    }
    return count;
}

static void rows_are_those_of_runs_that_find_their_own(void **state)
{
    Program *program = *state;
    double of_neighbours[RUNS];
    double of_each[RUNS];
    double from[RUNS];
    double apart[RUNS];
    write_text(program, "feeder.yaml", FEEDER);
    write_text(program, "n.yaml",
               "case: feeder.yaml\nvary: {drive.speed: {from: 100 rpm, to: 500 rpm, count: 6}}\n");
    write_text(program, "e.yaml",
               "case: feeder.yaml\nvary: {drive.speed: {from: 100 rpm, to: 500 rpm, count: 6}}\n"
               "settle: each\n");
    run_well(program, "study n.yaml");
    assert_says(program->output, "Of 6 settled runs 4 began in the motion of a neighbour");
    run_well(program, "study e.yaml -q");
    const char *const names[] = {"coupler_follower_settled_force_N",
                                 "coupler_follower_force_max_N"};
    for (int i = 0; i < 2; i++) {
        assert_true(read_column(program, "n.sqlite", names[i], of_neighbours));
        assert_true(read_column(program, "e.sqlite", names[i], of_each));
        for (int run = 0; run < RUNS; run++) {
            assert_true(fabs(of_neighbours[run] - of_each[run]) <= 1e-3 * of_each[run]);
        }
    }
    // a quarter and three quarters of the block along
    assert_true(read_column(program, "n.sqlite", "settled_from_run", from));
    assert_true(isnan(from[1]) && isnan(from[4]) && count_of(from) == RUNS - 2);
    assert_true(from[0] == 1.0 && from[3] == 2.0 && from[5] == 4.0);
    assert_true(read_column(program, "n.sqlite", "settled_apart", apart));
    assert_true(count_of(apart) == 1 && apart[4] <= 1e-3);
    assert_false(read_column(program, "e.sqlite", "settled_from_run", from));
}

// Reads all rows without the times that they took.
static void read_rows(Program *program, const char *store, char rows[ROWS_SIZE])
{
    char words[PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "study export %s", store);
    run_well(program, words);
    size_t length = 0;
    rows[0] = '\0';
    for (char *line = strtok(program->output, "\n"); line != NULL; line = strtok(NULL, "\n")) {
        *strrchr(line, ',') = '\0';
        length += (size_t)snprintf(rows + length, ROWS_SIZE - length, "%s\n", line);
        assert_true(length < ROWS_SIZE);
    }
}

// Two blocks, the second too short to have neighbours.
static void rows_are_the_same_in_parts(void **state)
{
    Program *program = *state;
    static char whole[ROWS_SIZE];
    static char parts[ROWS_SIZE];
    write_text(program, "feeder.yaml", FEEDER);
    write_text(program, "p.yaml",
               "case: feeder.yaml\nset: {run.settle-starts: 1}\n"
               "vary:\n"
               "  drive.speed: {from: 200 rpm, to: 400 rpm, count: 11}\n"
               "  contact.restitution: [0.4, 0.5]\n");
    run_well(program, "study p.yaml -q --jobs 1");
    read_rows(program, "p.sqlite", whole);
    run_well(program, "study p.yaml -q --jobs 3 --shard 1/2 --store a.sqlite");
    run_well(program, "study p.yaml -q --shard 2/2 --store b.sqlite");
    run_well(program, "study merge m.sqlite a.sqlite b.sqlite");
    read_rows(program, "m.sqlite", parts);
    assert_string_equal(whole, parts);
}

// Its numbers are known within the budget, and each run finds its own.
static void what_does_not_repeat_has_numbers_in_each_run(void **state)
{
    Program *program = *state;
    double from[RUNS];
    double force[RUNS];
    write_text(program, "loose.yaml", LOOSE);
    write_text(program, "l.yaml",
               "case: loose.yaml\nset: {run.settle-budget: 100 s, run.settle-least: 50, "
               "run.settle-to: 1}\n"
               "vary: {drive.speed: {from: 580 rpm, to: 620 rpm, count: 6}}\n");
    run_well(program, "study l.yaml -q");
    assert_true(read_column(program, "l.sqlite", "settled_from_run", from));
    assert_true(read_column(program, "l.sqlite", "rod_slider_settled_force_N", force));
    assert_int_equal(count_of(from), 0);
    assert_int_equal(count_of(force), RUNS);
}

// Too few revolutions to tell its numbers: most runs only begin in it.
static void what_is_too_dear_has_a_start_alone(void **state)
{
    Program *program = *state;
    double from[RUNS];
    double force[RUNS];
    double largest[RUNS];
    write_text(program, "loose.yaml", LOOSE);
    write_text(program, "d.yaml",
               "case: loose.yaml\nset: {run.settle-budget: 100 s, run.settle-least: 8, "
               "run.settle-most: 8, run.settle-to: 1}\n"
               "vary: {drive.speed: {from: 580 rpm, to: 620 rpm, count: 6}}\n");
    run_well(program, "study d.yaml -q");
    assert_true(read_column(program, "d.sqlite", "settled_from_run", from));
    assert_true(read_column(program, "d.sqlite", "rod_slider_settled_force_N", force));
    assert_true(read_column(program, "d.sqlite", "rod_slider_force_max_N", largest));
    assert_int_equal(count_of(from), RUNS - 2);
    assert_int_equal(count_of(force), 2);
    assert_int_equal(count_of(largest), RUNS);
}

// Who makes the runs is said: the reference where nobody speaks of ODE.
static void the_reference_makes_runs_that_nobody_asks_of_ode(void **state)
{
    Program *program = *state;
    double error[RUNS];
    double step[RUNS];
    write_text(program, "feeder.yaml", FEEDER);
    write_text(program, "r.yaml",
               "case: feeder.yaml\nset: {run.revolutions: 0.1, run.start: centred}\n"
               "vary: {drive.speed: {from: 100 rpm, to: 500 rpm, count: 6}}\n");
    write_text(program, "o.yaml",
               "case: feeder.yaml\nset: {run.revolutions: 0.1, run.start: centred, run.step: 50 us}"
               "\nvary: {drive.speed: {from: 100 rpm, to: 500 rpm, count: 6}}\n");
    run_well(program, "study r.yaml --dry-run");
    assert_says(program->output, "The reference makes the runs, to a tolerance of 1e-8");
    run_well(program, "study r.yaml -q");
    assert_false(read_column(program, "r.sqlite", "error_max", error));
    assert_true(read_column(program, "r.sqlite", "step_s", step));
    assert_int_equal(count_of(step), 0);
    run_well(program, "study o.yaml -q");
    assert_true(read_column(program, "o.sqlite", "error_max", error));
    assert_true(read_column(program, "o.sqlite", "step_s", step));
    assert_int_equal(count_of(error), RUNS);
    assert_true(step[0] == 50e-6);
}

int main(int argc, char **argv)
{
    const bool is_whole = argc > 1 && strcmp(argv[1], "--whole") == 0;
    const struct CMUnitTest tests[] = {
#define STUDY_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)
        STUDY_TEST(rows_are_those_of_runs_that_find_their_own),
        STUDY_TEST(rows_are_the_same_in_parts),
        STUDY_TEST(what_is_too_dear_has_a_start_alone),
        STUDY_TEST(the_reference_makes_runs_that_nobody_asks_of_ode),
        // a third of the time, and left out without --whole
        STUDY_TEST(what_does_not_repeat_has_numbers_in_each_run),
#undef STUDY_TEST
    };
    const size_t count = sizeof tests / sizeof *tests;
    return _cmocka_run_group_tests("study_neighbours", tests, is_whole ? count : count - 1, NULL,
                                   NULL);
}

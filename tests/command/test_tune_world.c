// Does the program against libjointplay that `jointplay tune` writes make the same run?
//
// It knows the world through ODE alone, and its numbers are not those of the program's own world to
// the last bit. Both are held against the reference: the largest difference of omega at any sample,
// relative to the body's largest. That of the library may be twice that of the program, or what was
// asked for.
#include "program.h"

#include <math.h>

enum { COLUMNS_MOST = 256, ROWS_MOST = 4096, LINE_SIZE = 1 << 14 };

// A series as CSV: heads, and one row a sample.
typedef struct Series {
    size_t column_count;
    size_t row_count;
    char *heads[COLUMNS_MOST];
    double *rows[ROWS_MOST];
} Series;

static Series *read_series(const Program *program, const char *name)
{
    char path[PROGRAM_PATH_SIZE];
    char line[LINE_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "r");
    assert_non_null(stream);
    Series *series = calloc(1, sizeof *series);
    assert_non_null(fgets(line, sizeof line, stream));
    for (char *head = strtok(line, ",\n"); head != NULL; head = strtok(NULL, ",\n")) {
        assert_true(series->column_count < COLUMNS_MOST);
        series->heads[series->column_count++] = strdup(head);
    }
    while (fgets(line, sizeof line, stream) != NULL) {
        assert_true(series->row_count < ROWS_MOST);
        double *row = calloc(series->column_count, sizeof *row);
        char *cell = line;
        for (size_t i = 0; i < series->column_count; i++) {
            row[i] = strtod(cell, NULL);
            cell += strcspn(cell, ",\n") + 1;
        }
        series->rows[series->row_count++] = row;
    }
    fclose(stream);
    return series;
}

static void free_series(Series *series)
{
    for (size_t i = 0; i < series->column_count; i++) {
        free(series->heads[i]);
    }
    for (size_t i = 0; i < series->row_count; i++) {
        free(series->rows[i]);
    }
    free(series);
}

static size_t column_of(const Series *series, const char *head)
{
    size_t column = 0;
    while (column < series->column_count && strcmp(series->heads[column], head) != 0) {
        column++;
    }
    assert_true(column < series->column_count);
    return column;
}

// The largest difference of omega from the truth, of all bodies.
static double error_of(const Series *run, const Series *truth)
{
    double error = 0.0;
    assert_int_equal(run->row_count, truth->row_count);
    for (size_t i = 0; i < run->column_count; i++) {
        const char *ending = strstr(run->heads[i], "_omega_rad_s");
        if (ending == NULL || strcmp(ending, "_omega_rad_s") != 0) {
            continue;
        }
        const size_t column = column_of(truth, run->heads[i]);
        double scale = 0.0;
        double largest = 0.0;
        for (size_t k = 0; k < run->row_count; k++) {
            assert_true(fabs(run->rows[k][0] - truth->rows[k][0]) < 1e-9);
            scale = fmax(scale, fabs(truth->rows[k][column]));
            largest = fmax(largest, fabs(run->rows[k][i] - truth->rows[k][column]));
        }
        error = scale > 0.0 ? fmax(error, largest / scale) : error;
    }
    return error;
}

static double error_in(const Program *program, const char *name, const Series *truth)
{
    Series *series = read_series(program, name);
    const double error = error_of(series, truth);
    free_series(series);
    return error;
}

// Builds a program with ODE and the library alone and not a warning, and runs it.
static void run_world(const Program *program, const char *name)
{
    char line[3 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line,
             "cd '%s' && $JOINTPLAY_CC -Wall -Wextra -Wshadow -Werror -o world %s.c "
             "-I\"$JOINTPLAY_HEADERS\" $(pkg-config --cflags --libs ode) "
             "-L\"$JOINTPLAY_LIBRARY\" -ljointplay -lm && "
             "LD_LIBRARY_PATH=\"$JOINTPLAY_LIBRARY\" ./world >%s.csv 2>words",
             program->folder, name, name);
    assert_int_equal(system(line), 0);
}

// The series of the setting by one of the program's own solvers.
static void run_own(Program *program, const char *command, const char *backend)
{
    char line[3 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line, "%s --set 'run.backends=[%s]' --series %s.csv --quiet",
             strchr(command, ' ') + 1, backend, backend);
    program_run(program, line);
    assert_int_equal(program->status, 0);
}

// What is asked for, and the setting.
typedef struct Wanted {
    const char *options;
    double asked;        // of the whole motion
    double error;        // of omega
    const char *changed; // for the control: what sed does to the program, so that it is wrong
} Wanted;

static void check_world(Program *program, const Wanted *wanted)
{
    char line[3 * PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line, "tune %s --error %g --code world.c --json --quiet", wanted->options,
             wanted->asked);
    program_run(program, line);
    if (program->status != 0) {
        fail_msg("%s: status %d: %s", line, program->status, program->errors);
    }
    json_t *root = program_json(program);
    const char *command =
        json_string_value(json_object_get(json_object_get(root, "best_at_step"), "command"));
    assert_non_null(command);
    run_own(program, command, "ode");
    run_own(program, command, "reference");
    json_decref(root);
    run_world(program, "world");
    Series *truth = read_series(program, "reference.csv");
    const double own = error_in(program, "ode.csv", truth);
    const double error = error_in(program, "world.csv", truth);
    print_message("# %.2e, of the program %.2e: %s\n", error, own, wanted->options);
    assert_true(error <= fmax(2.0 * own, wanted->error));
    snprintf(line, sizeof line, "cd '%s' && sed '%s' world.c >wrong.c && ! cmp -s world.c wrong.c",
             program->folder, wanted->changed);
    assert_int_equal(system(line), 0);
    run_world(program, "wrong");
    assert_false(error_in(program, "wrong.csv", truth) <= 2.0 * fmax(2.0 * own, wanted->error));
    free_series(truth);
}

static void check_worlds(void **state, const Wanted *wanted, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        check_world(*state, &wanted[i]);
    }
}

#define K66                                                                                        \
    "$cases/paper/impact-k66.yaml --set run.start=centred --set contact.resting-speed=none "       \
    "--schemes direct/staggered"

static void pins_in_holes_make_the_same_run(void **state)
{
    static const Wanted RUNS[] = {
        {K66 "/impulse --at-step '20 us' --set run.revolutions=0.1 --set run.samples=3000", 1e-3,
         3e-5, "s/restitution = 0.9/restitution = 0.8/"},
        {K66 "/midpoint --at-step '5 us' --set run.revolutions=0.1 --set run.samples=3000 "
             "--set contact.friction=0.1",
         1e-1, 1e-3, "s/friction = 0.1/friction = 0/"},
        {"$cases/mechanisms/slider-crank-pin.yaml --schemes direct/staggered/impulse "
         "--at-step '2 us' --set run.revolutions=0.05 --set run.samples=3000",
         1e-4, 1e-4, "s/stiffness = 6.6e+10/stiffness = 6.6e+9/"},
        // two pins of one bar, a hole off its place
        {"$cases/hard/two-pins.yaml --schemes direct/staggered/impulse --at-step '5 us' "
         "--set 'joints.left.at-a=[4 um, 0 mm]' --set 'joints.left.at-b=[0 mm, 0 mm]' "
         "--set run.samples=200",
         1e-3, 1e-5, "s/hole\\[0\\] = 4e-06/hole[0] = 0.0/"},
        // in the settled motion, whose contacts have begun long before
        {"$cases/paper/impact-k66.yaml --schemes direct/staggered/impulse --at-step '5 us' "
         "--set run.start=settled --set run.revolutions=0.1 --set run.samples=300",
         1e-3, 1e-5, "s/impact_speed = 0.0/impact_speed = 10.0/"},
        // friction that sticks
        {"$cases/mechanisms/start-and-stop.yaml --schemes direct/staggered/impulse "
         "--at-step '10 us' --set run.duration='12 ms' --set run.samples=1200 "
         "--set contact.friction=0.1 --set contact.friction-law=stick",
         1e-3, 1e-6, "s/JP_FRICTION_STICK/JP_FRICTION_REGULARIZED/"},
    };
    check_worlds(state, RUNS, sizeof RUNS / sizeof *RUNS);
}

static void stops_and_backlash_make_the_same_run(void **state)
{
    static const Wanted RUNS[] = {
        {"$cases/mechanisms/stop-rebound.yaml --schemes direct/staggered/impulse "
         "--at-step '0.5 ms' --set run.samples=300",
         1e-4, 1e-4, "s/high = /high = 0.01 + /"},
        {"$cases/mechanisms/servo-backlash.yaml --schemes direct/staggered/midpoint "
         "--at-step '0.1 ms' --set run.duration='1.5 s' --set run.samples=15",
         1e-3, 1e-3, "s/gap = /gap = 0.9 * /"},
    };
    check_worlds(state, RUNS, sizeof RUNS / sizeof *RUNS);
}

static void what_drives_and_pushes_makes_the_same_run(void **state)
{
    static const Wanted RUNS[] = {
        {"$cases/mechanisms/start-and-stop.yaml --schemes direct/staggered/impulse "
         "--at-step '10 us' --set run.duration='12 ms' --set run.samples=1200",
         1e-4, 1e-5, "s/(i + 1) \\* STEP))/i * STEP))/"},
        {"$cases/mechanisms/start-and-stop.yaml --schemes direct/staggered/impulse "
         "--at-step '20 us' --set drive.speed='[[10 ms, 400 rpm], [60 ms, 800 rpm]]' "
         "--set drive.period='100 ms' --set run.duration='150 ms' --set run.samples=150",
         1e-3, 2e-4, "s/fmod((i + 1) \\* STEP, 0.1)/(i + 1) * STEP/"},
        {"$cases/mechanisms/run-up.yaml --schemes direct/staggered/impulse --at-step '10 us' "
         "--set run.duration='10 ms' --set run.samples=1000",
         1e-3, 2e-4, "s/middle = (i + 0.5)/middle = 1.01 * (i + 0.5)/"},
        {"$cases/mechanisms/andrews.yaml --schemes direct/staggered --at-step '10 us' "
         "--set run.duration='10 ms' --set run.samples=100",
         1e-4, 1e-4, "s/4.53e+03/4e+03/"},
    };
    check_worlds(state, RUNS, sizeof RUNS / sizeof *RUNS);
}

#define RUBBING                                                                                    \
    "$cases/mechanisms/andrews.yaml --schemes direct/staggered --at-step '10 us' "                 \
    "--set run.duration='10 ms' --set run.samples=100 --set joints.F.friction=0.2 "                \
    "--set joints.F.friction-radius='2 mm' "

static void ideal_joints_rub_in_the_same_way(void **state)
{
    static const Wanted RUNS[] = {
        {RUBBING "--set joints.B.friction-torque='2 N mm'", 1e-3, 1e-3,
         "s/steady = 0.002/steady = 0.02/"},
        {RUBBING "--set joints.F.friction-law=stick", 1e-3, 1e-3,
         "s/coefficient = 0.2/coefficient = 0.6/"},
    };
    check_worlds(state, RUNS, sizeof RUNS / sizeof *RUNS);
}

// Nothing is searched for that cannot be written.
static void expect_refused(Program *program, const char *options, const char *reason)
{
    char line[2 * PROGRAM_PATH_SIZE];
    char path[PROGRAM_PATH_SIZE];
    snprintf(line, sizeof line, "tune %s --code none.c", options);
    program_run(program, line);
    assert_int_equal(program->status, 2);
    assert_says(program->errors, "--code: ");
    assert_says(program->errors, reason);
    assert_string_equal(program->output, "");
    program_path(program, "none.c", path);
    assert_int_not_equal(access(path, F_OK), 0);
}

static void what_the_library_cannot_do_is_refused(void **state)
{
    expect_refused(*state, "$cases/mechanisms/gear-pair.yaml --error 1e-1",
                   "libjointplay has no pair of gears");
    expect_refused(*state, "$cases/paper/ideal-nominal.yaml --error 1e-2 --schemes extrapolated",
                   "libjointplay does not extrapolate from several worlds");
    expect_refused(*state,
                   "$cases/paper/impact-k66.yaml --set run.start=centred --set "
                   "contact.resting-speed=none --error 3e-2 --set ode.facets=64 "
                   "--schemes direct/plain/textbook/staves",
                   "libjointplay has round holes and no polygons");
    expect_refused(*state, "$cases/mechanisms/compressor.yaml --error 1e-2",
                   "programs have no loads, motors or soft drives");
    expect_refused(*state, "$cases/mechanisms/five-bar.yaml --error 1e-2",
                   "programs have one drive, of a speed");
    expect_refused(*state, "$cases/space/offset-coupler.yaml --error 1e-2",
                   "programs are written for cases in the plane alone");
}

// Of several schemes those stay that the library has.
static void what_the_library_lacks_is_left_out(void **state)
{
    Program *program = *state;
    program_run(program,
                "tune --full $cases/paper/ideal-nominal.yaml --error 1e-2 --cost steps --schemes "
                "extrapolated,direct/staggered --set run.revolutions=0.1 --code some.c");
    assert_int_equal(program->status, 0);
    assert_says(program->errors, "left out for --code: ");
    assert_says(program->errors, "libjointplay does not extrapolate from several worlds");
    assert_says(program->output, "Run with libjointplay, at steps of ");
}

// What moves on a bristle is told where the library would count a crank that a motor drives.
static void a_body_with_a_motor_does_not_move_on_a_bristle(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_run(program, "tune $cases/mechanisms/start-and-stop.yaml --at-step '20 us' "
                         "--schemes direct/staggered/impulse --set run.duration='1 ms' "
                         "--set run.samples=20 --set joints.crank-coupler.hole='10.03 mm' "
                         "--set joints.crank-coupler.pin='10 mm' --set contact.friction=0.1 "
                         "--set contact.friction-law=stick --code stick.c");
    if (program->status != 0) {
        fail_msg("%s", program->errors);
    }
    program_path(program, "stick.c", path);
    program_read(path, program->output);
    assert_says(program->output, "presliding_mass = 0.29; // kg");
}

static void the_program_is_short(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_run(program, "tune $cases/paper/impact-k66.yaml --set run.start=centred --set "
                         "contact.resting-speed=none --at-step '20 us' --schemes "
                         "direct/staggered/impulse --set run.revolutions=0.1 --code short.c");
    assert_int_equal(program->status, 0);
    program_path(program, "short.c", path);
    program_read(path, program->output);
    size_t lines = 0;
    for (const char *at = program->output; *at != '\0'; at++) {
        lines += *at == '\n' ? 1 : 0;
    }
    assert_in_range(lines, 80, 150);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(pins_in_holes_make_the_same_run, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(stops_and_backlash_make_the_same_run, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(what_drives_and_pushes_makes_the_same_run, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(ideal_joints_rub_in_the_same_way, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(what_the_library_cannot_do_is_refused, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(what_the_library_lacks_is_left_out, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_body_with_a_motor_does_not_move_on_a_bristle,
                                        program_set_up, program_tear_down),
        cmocka_unit_test_setup_teardown(the_program_is_short, program_set_up, program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

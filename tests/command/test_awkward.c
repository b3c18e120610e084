// Do awkward mechanisms end, with a sentence that names the cause and the crank angle where they
// fail? A test that hangs is ended by its time limit; tests/measure/awkward.sh runs them all.
#include "program.h"

#include "random_case.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Writes a case of a kind and runs it on a solver with options.
static void run_case(Program *program, const CaseKind *kind, uint64_t seed, const char *options)
{
    char path[PROGRAM_PATH_SIZE];
    char words[PROGRAM_PATH_SIZE];
    program_path(program, "case.yaml", path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    kind->write(seed, stream);
    fclose(stream);
    snprintf(words, sizeof words, "run case.yaml --quiet %s", options);
    program_run(program, words);
}

static const char REFERENCE[] = "--backend reference";
static const char IMPULSE[] = "--backend ode --step '5 us' --set ode.stepping=staggered "
                              "--set ode.map=impulse";
static const char PLAIN[] = "--backend ode --step '5 us'";

static void complete(Program *program, const CaseKind *kind, uint64_t seed, const char *solver,
                     const char *options)
{
    char words[PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "%s %s", solver, options);
    run_case(program, kind, seed, words);
    if (program->status != 0) {
        fail_msg("%s %d %s: status %d, %s", kind->name, (int)seed, words, program->status,
                 program->errors);
    }
}

static void equal_mechanisms_run_to_their_end(void **state)
{
    Program *program = *state;
    // let go in the middle of their holes they fall on the wall within 6 ms, and bounce
    const char *const short_run = "--set run.duration=15ms";
    for (uint64_t seed = 0; seed < 4; seed++) {
        complete(program, &CASE_PENDULA, seed, REFERENCE, short_run);
        complete(program, &CASE_PENDULA, seed, IMPULSE, short_run);
        complete(program, &CASE_FOUR_BARS, seed, REFERENCE, short_run);
        complete(program, &CASE_FOUR_BARS, seed, IMPULSE, short_run);
    }
}

static void pins_that_start_on_the_wall_run_to_their_end(void **state)
{
    Program *program = *state;
    // of seed 3 the damping is a thousand million times the usual
    for (uint64_t seed = 0; seed < 6; seed++) {
        // what is hard is the start
        complete(program, &CASE_TOUCHING, seed, REFERENCE, "--set run.duration=5ms");
        complete(program, &CASE_TOUCHING, seed, IMPULSE, "--set run.duration=5ms");
    }
}

static void change_points_are_passed(void **state)
{
    Program *program = *state;
    // a parallelogram has a change point at either end of half a turn, a kite has one a turn
    const char *const turns[] = {"0.5", "0.5", "1", "0.5"};
    for (uint64_t seed = 0; seed < 4; seed++) {
        char options[64];
        // one is certified, which is done by passing it some times more
        snprintf(options, sizeof options, "%s--set run.revolutions=%s",
                 seed == 0 ? "" : "--uncertified ", turns[seed]);
        complete(program, &CASE_CHANGE_POINT, seed, REFERENCE, options);
    }
}

static void a_lock_is_called_a_lock_on_every_solver(void **state)
{
    Program *program = *state;
    const char *const solvers[] = {REFERENCE, PLAIN, IMPULSE};
    for (uint64_t seed = 0; seed < 4; seed++) {
        for (size_t i = 0; i < sizeof solvers / sizeof *solvers; i++) {
            run_case(program, &CASE_LOCK, seed, solvers[i]);
            assert_int_equal(program->status, 4);
            assert_says(program->errors, "with ideal joints the mechanism locks at a crank angle");
            assert_says(program->errors, "run fewer revolutions or change the lengths");
        }
    }
    // no step passes it, and so none is asked for
    run_case(program, &CASE_LOCK, 0, "--backend ode --step auto");
    assert_int_equal(program->status, 4);
    assert_says(program->errors, "no step can be chosen");
    assert_says(program->errors, "run fewer revolutions or change the lengths");
    assert_null(strstr(program->errors, "give run.step"));
    // the control: a run that ends before it gets there says nothing of the kind
    run_case(program, &CASE_LOCK, 0, "--backend reference --set run.revolutions=0.01");
    assert_int_equal(program->status, 0);
}

// Writes a case that locks, with a pendulum beside the mechanism.
static void write_with_pendulum(Program *program, uint64_t seed)
{
    char path[PROGRAM_PATH_SIZE];
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    assert_non_null(memory);
    CASE_LOCK.write(seed, memory);
    fclose(memory);
    program_path(program, "case.yaml", path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    for (char *line = strtok(text, "\n"); line != NULL; line = strtok(NULL, "\n")) {
        fprintf(stream, "%s\n", line);
        if (strcmp(line, "bodies:") == 0) {
            fputs("  bob: {mass: 1 kg, inertia: 0.1 kg m^2, at: [9.5 m, 0 m]}\n", stream);
        } else if (strcmp(line, "joints:") == 0) {
            fputs("  hook: {between: [ground, bob], at: [9 m, 0 m]}\n", stream);
        }
    }
    fclose(stream);
    free(text);
}

// The pendulum is ahead of the mechanism by up to half a turn of the crank, or behind it.
static void a_lock_is_called_a_lock_beside_another_mechanism(void **state)
{
    Program *program = *state;
    for (uint64_t seed = 0; seed < 4; seed++) {
        write_with_pendulum(program, seed);
        program_run(program, "run case.yaml --quiet --backend reference --set run.samples=36");
        assert_int_equal(program->status, 4);
        assert_says(program->errors, "with ideal joints the mechanism locks at a crank angle");
    }
}

// Without a drive there is no crank angle to speak of.
static void a_pin_through_its_wall_is_told_with_joint_and_time(void **state)
{
    Program *program = *state;
    const char *const solvers[] = {REFERENCE, PLAIN, IMPULSE};
    for (size_t i = 0; i < sizeof solvers / sizeof *solvers; i++) {
        run_case(program, &CASE_SEPARATING, 0, solvers[i]);
        assert_int_equal(program->status, 4);
        assert_says(program->errors, "at ");
        assert_says(program->errors, " ms");
        assert_says(program->errors, "inside the wall of its hole");
        assert_null(strstr(program->errors, "crank angle"));
    }
    // here a step of one's own is of use
    run_case(program, &CASE_SEPARATING, 0, "--backend ode --step auto");
    assert_int_equal(program->status, 4);
    assert_says(program->errors, "give run.step");
}

static void masses_far_apart_are_followed(void **state)
{
    Program *program = *state;
    // 1e5 kg beside .1 mg; ODE with a step of 1 us ends after 163147 steps, with the same words
    run_case(program, &CASE_SEPARATING, 3,
             "--backend reference --set reference.tolerance=1e-9 "
             "--set contact.damping=lankarani-nikravesh "
             "--set contact.resting-speed=none");
    assert_int_equal(program->status, 4);
    // not what a slow machine says meanwhile of how far the run has come
    const char *at = strstr(program->errors, ": at ");
    assert_non_null(at);
    assert_near(strtod(at + strlen(": at "), NULL), 163.147, 1e-3);
    assert_says(program->errors, "the pin of pin-0 is 0.5 mm inside the wall of its hole");
}

#define COMMAND_TEST(name) cmocka_unit_test_setup_teardown(name, program_set_up, program_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        COMMAND_TEST(equal_mechanisms_run_to_their_end),
        COMMAND_TEST(pins_that_start_on_the_wall_run_to_their_end),
        COMMAND_TEST(change_points_are_passed),
        COMMAND_TEST(a_lock_is_called_a_lock_on_every_solver),
        COMMAND_TEST(a_lock_is_called_a_lock_beside_another_mechanism),
        COMMAND_TEST(a_pin_through_its_wall_is_told_with_joint_and_time),
        COMMAND_TEST(masses_far_apart_are_followed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

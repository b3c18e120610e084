// Does docs/leapfrog.c show what it says: ODE of second order, and of first the textbook's way?
//
// Outside truth: the same pendulum by its angular momentum about the pivot, with RK4.
//     n' = w x n,  L' = l n x (m g + (0, 0, F)),  w = L / J + (1/I - 1/J) (L . n) n
// n unit vector along the rod; L, kg m^2/s; l length, m; I moment of inertia about any axis through
// the bob, J = I + m l^2 that across the rod at the pivot, kg m^2; g gravity as the floor has it,
// m/s^2; F the floor's force, N.
// The program is JOINTPLAY_PROGRAM, its text JOINTPLAY_SOURCE.
#include "close.h"
#include "program.h"

enum { STATE_SIZE = 6, CLIMB_COUNT = 4, TRUTH_STEPS = 20000, LINE_MAX_COUNT = 60 };

static const double MASS = 1.0;                     // kg
static const double INERTIA = 1.0;                  // kg m^2
static const double LENGTH = 3.0;                   // m
static const double GRAVITY[3] = {0.0, -5.0, -8.5}; // m/s^2
static const double STIFFNESS = 1e4;                // N/m
static const double DAMPING = 40.0;                 // N s/m
static const double FLOOR = -1.8;                   // m
static const double END = 0.4;                      // s

static const double STEPS[CLIMB_COUNT] = {0.002, 0.001, 0.0005, 0.00025}; // s
static const size_t MIDDLE = 1;                                           // of the steps

// |x - truth|, m, and |v - truth|, m/s, at the end
typedef struct PendulumError {
    double place;
    double speed;
} PendulumError;

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double *a, const double *b, double factor, double *product)
{
    product[0] = factor * (a[1] * b[2] - a[2] * b[1]);
    product[1] = factor * (a[2] * b[0] - a[0] * b[2]);
    product[2] = factor * (a[0] * b[1] - a[1] * b[0]);
}

// Of a state (n, L); returns the floor's force, which never pulls.
static double rate_of(const double *state, double *rate)
{
    const double *rod = state;
    const double *momentum = state + 3;
    const double across = INERTIA + MASS * LENGTH * LENGTH;
    const double along = (1.0 / INERTIA - 1.0 / across) * dot(momentum, rod);
    double omega[3];
    for (int i = 0; i < 3; i++) {
        omega[i] = momentum[i] / across + along * rod[i];
    }
    cross(omega, rod, 1.0, rate);
    const double force =
        fmax(0.0, STIFFNESS * (FLOOR - LENGTH * rod[2]) - DAMPING * LENGTH * rate[2]);
    const double load[3] = {MASS * GRAVITY[0], MASS * GRAVITY[1], MASS * GRAVITY[2] + force};
    cross(rod, load, LENGTH, rate + 3);
    return force;
}

static void rk4_step(double *state, double step)
{
    static const double SHARES[4] = {0.0, 0.5, 0.5, 1.0};
    static const double WEIGHTS[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    double rate[STATE_SIZE] = {0.0};
    double sum[STATE_SIZE] = {0.0};
    for (int stage = 0; stage < 4; stage++) {
        double at[STATE_SIZE];
        for (int i = 0; i < STATE_SIZE; i++) {
            at[i] = state[i] + SHARES[stage] * step * rate[i];
        }
        // the whole of it is smooth: the bob never leaves the floor
        assert_true(rate_of(at, rate) > 0.0);
        for (int i = 0; i < STATE_SIZE; i++) {
            sum[i] += WEIGHTS[stage] * rate[i];
        }
    }
    for (int i = 0; i < STATE_SIZE; i++) {
        state[i] += step * sum[i];
    }
}

// Place and velocity of the bob at the end.
static void pendulum_truth(int steps, double *truth)
{
    static const double START[3] = {0.8, 0.0, -0.6};
    static const double OMEGA[3] = {0.0, 0.02, 1.2};
    const double across = INERTIA + MASS * LENGTH * LENGTH;
    const double spin = dot(OMEGA, START);
    double state[STATE_SIZE];
    double rate[STATE_SIZE];
    for (int i = 0; i < 3; i++) {
        state[i] = START[i];
        state[3 + i] = across * OMEGA[i] + (INERTIA - across) * spin * START[i];
    }
    for (int i = 0; i < steps; i++) {
        rk4_step(state, END / steps);
    }
    rate_of(state, rate);
    for (int i = 0; i < 3; i++) {
        truth[i] = LENGTH * state[i];
        truth[3 + i] = LENGTH * rate[i];
    }
}

static double distance(const double *a, const double *b)
{
    const double apart[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(dot(apart, apart));
}

static PendulumError error_of(Program *program, double step, const char *way)
{
    char words[64];
    double found[STATE_SIZE];
    double truth[STATE_SIZE];
    snprintf(words, sizeof words, "%.17g %s", step, way);
    program_run(program, words);
    assert_int_equal(program->status, 0);
    char *next = program->output;
    for (int i = 0; i < STATE_SIZE; i++) {
        char *start = next;
        found[i] = strtod(start, &next);
        assert_ptr_not_equal(next, start);
    }
    assert_string_equal(next, "\n");
    pendulum_truth(TRUTH_STEPS, truth);
    return (PendulumError){distance(found, truth), distance(found + 3, truth + 3)};
}

// At each halving of the step, of places and of speeds.
static void check_order(Program *program, const char *way, double order)
{
    PendulumError last = error_of(program, STEPS[0], way);
    for (size_t i = 1; i < CLIMB_COUNT; i++) {
        const PendulumError error = error_of(program, STEPS[i], way);
        // the next term is below 2 % here; 0.15 is what counts as that order
        assert_near(log2(last.place / error.place), order, 0.15);
        assert_near(log2(last.speed / error.speed), order, 0.15);
        last = error;
    }
}

static void the_truth_is_exact_beside_the_errors(void **state)
{
    (void)state;
    double coarse[STATE_SIZE];
    double fine[STATE_SIZE];
    pendulum_truth(TRUTH_STEPS / 2, coarse);
    pendulum_truth(TRUTH_STEPS, fine);
    // the smallest error looked at is 4e-8
    assert_true(distance(coarse, fine) < 1e-12);
    assert_true(distance(coarse + 3, fine + 3) < 1e-12);
}

static void read_as_a_leapfrog_it_is_of_second_order(void **state)
{
    check_order(*state, "", 2.0);
}

// The control: the textbook's map, ERP 0.2, and the step's end as it stands.
static void the_plain_way_is_of_first_order_and_far_worse(void **state)
{
    check_order(*state, "plain", 1.0);
    const PendulumError leapfrog = error_of(*state, STEPS[MIDDLE], "");
    const PendulumError plain = error_of(*state, STEPS[MIDDLE], "plain");
    // places 1300 times, speeds 94 times
    assert_true(plain.place > 20.0 * leapfrog.place);
    assert_true(plain.speed > 20.0 * leapfrog.speed);
}

static void it_fits_on_a_page(void **state)
{
    (void)state;
    FILE *stream = fopen(getenv("JOINTPLAY_SOURCE"), "r");
    assert_non_null(stream);
    int lines = 0;
    for (int letter = getc(stream); letter != EOF; letter = getc(stream)) {
        lines += letter == '\n';
    }
    fclose(stream);
    assert_in_range(lines, 1, LINE_MAX_COUNT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_truth_is_exact_beside_the_errors),
        cmocka_unit_test_setup_teardown(read_as_a_leapfrog_it_is_of_second_order, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(the_plain_way_is_of_first_order_and_far_worse,
                                        program_set_up, program_tear_down),
        cmocka_unit_test(it_fits_on_a_page),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

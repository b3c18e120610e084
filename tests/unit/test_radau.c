// Is the implicit integrator of the order it claims, and are its steps as long as the motion is
// smooth?
#include "close.h"

#include "reference/integrators.h"

// Couplings: polynomials of degree 6 up to each node; weights: of degree 12, and not of degree 13.
static void the_coefficients_integrate_polynomials(void **state)
{
    (void)state;
    for (int i = 0; i < RADAU_STAGES; i++) {
        const int last = i + 1 == RADAU_STAGES ? 13 : 7;
        for (int p = 1; p <= last + 1; p++) {
            double sum = 0.0;
            for (int j = 0; j < RADAU_STAGES; j++) {
                sum += RADAU_COUPLING[i][j] * pow(RADAU_NODE[j], p - 1);
            }
            const double integral = pow(RADAU_NODE[i], p) / p;
            if (p <= last) {
                assert_near(sum, integral, 1e-15);
            } else {
                assert_true(fabs(sum - integral) > 1e-9);
            }
        }
    }
}

// P_7(2 s - 1) begins with 3432 s^7, P_6 with 924 s^6.
static void the_last_coefficients_see_their_degree_alone(void **state)
{
    (void)state;
    for (int k = 1; k <= 7; k++) {
        double sums[2] = {0.0, 0.0};
        for (int i = 0; i < RADAU_STAGES; i++) {
            sums[0] += RADAU_LAST[0][i] * pow(RADAU_NODE[i], k);
            sums[1] += RADAU_LAST[1][i] * pow(RADAU_NODE[i], k);
        }
        assert_near(sums[0], k == 7 ? 1.0 / 3432.0 : 0.0, 1e-15);
        if (k <= 6) {
            assert_near(sums[1], k == 6 ? 1.0 / 924.0 : 0.0, 1e-15);
        }
    }
}

typedef struct Stiff {
    double decay; // 1/s
} Stiff;

// y'' = -w (y' - cos t) - sin t: from y = 0, y' = 1 that is sin t, whatever w.
static void held_to_a_sine(double time, const double *y, double *rates, void *context)
{
    const Stiff *stiff = context;
    rates[0] = y[1];
    rates[1] = -stiff->decay * (y[1] - cos(time)) - sin(time);
    rates[2] = y[1] * y[1];
}

static void pendulum(double time, const double *y, double *rates, void *context)
{
    (void)time;
    (void)context;
    rates[0] = y[1];
    rates[1] = -sin(y[0]);
    rates[2] = y[1] * y[1];
}

static Radau *start_at(Dop853 *integrator, Dop853Rates rates, Stiff *stiff, double place,
                       double rate)
{
    dop853_init(integrator, 3, 2);
    Radau *radau = radau_create(integrator);
    integrator->rates = rates;
    integrator->context = stiff;
    integrator->method = &radau->method;
    for (int i = 0; i < 3; i++) {
        integrator->fixed[i] = 1e-13;
    }
    radau->nudge[0] = radau->nudge[1] = 1e-7;
    const double y[3] = {place, rate, 0.0};
    dop853_start(integrator, 0.0, y);
    radau_find_decay(radau, integrator);
    return radau;
}

static void finish(Dop853 *integrator, Radau *radau)
{
    radau_destroy(radau);
    dop853_finish(integrator);
}

// The pendulum from 2 rad at rest, a second on in so many steps; and where it is in the middle of
// the last.
static double swing(int steps, double *between)
{
    Dop853 integrator;
    Radau *radau = start_at(&integrator, pendulum, NULL, 2.0, 0.0);
    for (int i = 0; i < steps; i++) {
        assert_true(dop853_try(&integrator, 2.0 / steps) < INFINITY);
        dop853_fill(&integrator);
        *between = dop853_dense(&integrator, integrator.time + 0.5 * integrator.tried)[0];
        dop853_accept(&integrator);
    }
    const double end = integrator.y[0];
    finish(&integrator, radau);
    return end;
}

static void halving_the_step_divides_the_error_by_two_to_the_thirteenth(void **state)
{
    (void)state;
    double between;
    const double truth = swing(64, &between);
    const double coarse = fabs(swing(1, &between) - truth);
    const double fine = fabs(swing(2, &between) - truth);
    assert_true(fine > 1e-14);
    assert_true(log2(coarse / fine) > 11.0);
}

static void the_polynomial_is_of_order_seven(void **state)
{
    (void)state;
    double truth;
    double errors[2];
    for (int k = 0; k < 2; k++) {
        const int steps = 4 << k;
        swing(steps, &errors[k]);
        // the middle of the last step is the end of a run of another length
        Dop853 integrator;
        Radau *radau = start_at(&integrator, pendulum, NULL, 2.0, 0.0);
        for (int i = 0; i < 32; i++) {
            dop853_try(&integrator, (2.0 - 1.0 / steps) / 32.0);
            dop853_fill(&integrator);
            dop853_accept(&integrator);
        }
        truth = integrator.y[0];
        errors[k] = fabs(errors[k] - truth);
        finish(&integrator, radau);
    }
    assert_true(log2(errors[0] / errors[1]) > 6.5);
}

// Steps taken to the end, within an error, and whether the sine was kept to.
static size_t follow_sine(double decay, bool is_implicit)
{
    Stiff stiff = {decay};
    Dop853 integrator;
    Radau *radau = start_at(&integrator, held_to_a_sine, &stiff, 0.0, 1.0);
    integrator.method = is_implicit ? &radau->method : NULL;
    integrator.step = 1e-3;
    while (integrator.time < 3.0 && integrator.accepted < 20000) {
        assert_true(dop853_attempt(&integrator, 3.0 - integrator.time));
        dop853_fill(&integrator);
        dop853_accept(&integrator);
    }
    if (is_implicit) {
        assert_near(integrator.time, 3.0, 1e-12);
        assert_near(integrator.y[0], sin(3.0), 1e-12);
        assert_near(integrator.y[2], 1.5 + 0.25 * sin(6.0), 1e-11);
    }
    const size_t accepted = integrator.accepted;
    finish(&integrator, radau);
    return accepted;
}

static void steps_do_not_see_what_has_died_away(void **state)
{
    (void)state;
    const size_t soft = follow_sine(1.0, true);
    assert_true(follow_sine(1e6, true) < 2 * soft);
    assert_true(follow_sine(1e12, true) < 2 * soft);
    // those of the explicit method do: some three time constants each
    assert_true(follow_sine(1e6, false) == 20000);
}

// Three coordinates, of which the first and the last are one system: y'' = -4 (y - other), and the
// one between them a pendulum.
static void pendulum_between_two(double time, const double *y, double *rates, void *context)
{
    (void)time;
    (void)context;
    for (int i = 0; i < 3; i++) {
        rates[i] = y[3 + i];
    }
    rates[3] = -4.0 * (y[0] - y[2]);
    rates[4] = -sin(y[1]);
    rates[5] = -4.0 * (y[2] - y[0]);
    rates[6] = y[4] * y[4];
}

// The two swing against each other with the square of the frequency 8 s^-2.
static void systems_side_by_side_move_as_each_alone(void **state)
{
    (void)state;
    Dop853 integrator;
    dop853_init(&integrator, 7, 6);
    Radau *radau = radau_create(&integrator);
    integrator.rates = pendulum_between_two;
    integrator.method = &radau->method;
    for (int i = 0; i < 7; i++) {
        integrator.fixed[i] = 1e-13;
    }
    for (int i = 0; i < 6; i++) {
        radau->nudge[i] = 1e-7;
    }
    const double y[7] = {1.0, 2.0, -1.0};
    dop853_start(&integrator, 0.0, y);
    radau_find_decay(radau, &integrator);
    for (int i = 0; i < 64; i++) {
        assert_true(dop853_try(&integrator, 2.0 / 64.0) < INFINITY);
        dop853_fill(&integrator);
        dop853_accept(&integrator);
    }
    double between;
    assert_near(integrator.y[1], swing(64, &between), 1e-14);
    assert_near(integrator.y[0], cos(2.0 * sqrt(8.0)), 1e-12);
    assert_near(integrator.y[2], -integrator.y[0], 1e-12);
    // control: they are solved for in two blocks, the larger one of coordinates that are not
    // neighbours
    assert_int_equal(radau->newton.block_count, 2);
    assert_int_equal(radau->newton.blocks[0].size, 2);
    assert_int_equal(radau->newton.coordinates[1], 2);
    finish(&integrator, radau);
}

static void decay_is_measured(void **state)
{
    (void)state;
    Stiff stiff = {1e6};
    Dop853 integrator;
    Radau *radau = start_at(&integrator, held_to_a_sine, &stiff, 0.0, 1.0);
    assert_close(radau_find_decay(radau, &integrator), 1e6, 1e-6);
    finish(&integrator, radau);
}

// Three coordinates that die away with 1, 4 and 10 1/s, turned against one another.
static void three_dampers(double time, const double *y, double *rates, void *context)
{
    (void)time;
    (void)context;
    const double common = (y[3] + y[4] + y[5]) / 3.0;
    static const double DECAYS[] = {1.0, 4.0, 10.0};
    for (int i = 0; i < 3; i++) {
        rates[i] = y[3 + i];
        rates[3 + i] = -DECAYS[i] * y[3 + i] - 1e-3 * common;
    }
    rates[6] = 0.0;
}

// Steps are held back by the largest rate; of contacts side by side the sum is no such thing.
static void the_largest_rate_of_decay_counts(void **state)
{
    (void)state;
    Dop853 integrator;
    dop853_init(&integrator, 7, 6);
    Radau *radau = radau_create(&integrator);
    integrator.rates = three_dampers;
    for (int i = 0; i < 6; i++) {
        radau->nudge[i] = 1e-7;
    }
    dop853_start(&integrator, 0.0, integrator.y);
    assert_close(radau_find_decay(radau, &integrator), 10.0, 0.01);
    finish(&integrator, radau);
}

static void what_cannot_be_solved_for_fails(void **state)
{
    (void)state;
    Stiff stiff = {NAN};
    Dop853 integrator;
    Radau *radau = start_at(&integrator, held_to_a_sine, &stiff, 0.0, 1.0);
    integrator.step = 1e-3;
    integrator.shortest = 1e-9;
    assert_false(dop853_attempt(&integrator, 1.0));
    assert_true(isnan(integrator.next[0]));
    finish(&integrator, radau);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_coefficients_integrate_polynomials),
        cmocka_unit_test(the_last_coefficients_see_their_degree_alone),
        cmocka_unit_test(halving_the_step_divides_the_error_by_two_to_the_thirteenth),
        cmocka_unit_test(the_polynomial_is_of_order_seven),
        cmocka_unit_test(steps_do_not_see_what_has_died_away),
        cmocka_unit_test(systems_side_by_side_move_as_each_alone),
        cmocka_unit_test(decay_is_measured),
        cmocka_unit_test(the_largest_rate_of_decay_counts),
        cmocka_unit_test(what_cannot_be_solved_for_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

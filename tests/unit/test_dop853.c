// Is the integrator of the order it claims, in its steps and in between?
#include "close.h"

#include "reference/integrators.h"

// The order conditions of pure quadrature: sum b_i c_i^(p-1) = 1/p up to p = 8, and not at p = 9.
static void the_weights_integrate_polynomials_up_to_the_order(void **state)
{
    (void)state;
    for (int p = 1; p <= 9; p++) {
        double sum = 0.0;
        for (int i = 0; i < 12; i++) {
            sum += DOP853_COUPLING[12][i] * pow(DOP853_NODE[i], p - 1);
        }
        if (p <= 8) {
            // weights up to 6 leave a rounding of that size
            assert_near(sum, 1.0 / p, 1e-15);
        } else {
            assert_true(fabs(sum - 1.0 / p) > 1e-9);
        }
    }
}

static void each_stage_stands_at_its_node(void **state)
{
    (void)state;
    for (int i = 1; i < DOP853_STAGES; i++) {
        double sum = 0.0;
        for (int j = 0; j < i; j++) {
            sum += DOP853_COUPLING[i][j];
        }
        // couplings up to 43 leave some roundings
        assert_near(sum, DOP853_NODE[i], 1e-14);
    }
}

// A pendulum without small angles, energy and an outside truth by halving: y'' = -sin y.
static void pendulum(double time, const double *y, double *rates, void *context)
{
    (void)time;
    (void)context;
    rates[0] = y[1];
    rates[1] = -sin(y[0]);
}

static void start_at(Dop853 *integrator, double angle)
{
    dop853_init(integrator, 2, 2);
    integrator->rates = pendulum;
    const double y[2] = {angle, 0.0};
    dop853_start(integrator, 0.0, y);
}

// The state at time 2 after equal steps, and at time 1.9 from the polynomial of the last one.
static void swing(int steps, double *end, double *between)
{
    Dop853 integrator;
    start_at(&integrator, 2.0);
    for (int i = 0; i < steps; i++) {
        dop853_try(&integrator, 2.0 / steps);
        if (i + 1 == steps) {
            *between = dop853_dense(&integrator, 2.0 - 0.3 * 2.0 / steps)[0];
        }
        dop853_accept(&integrator);
    }
    *end = integrator.y[0];
    dop853_finish(&integrator);
}

static void halving_the_step_divides_the_error_by_two_to_the_eighth(void **state)
{
    (void)state;
    double truth;
    double ignored;
    swing(512, &truth, &ignored);
    double coarse;
    double fine;
    swing(8, &coarse, &ignored);
    swing(16, &fine, &ignored);
    assert_near(log2(fabs(coarse - truth) / fabs(fine - truth)), 8.0, 1.0);
}

static void the_polynomial_is_as_good_as_the_steps_to_one_order(void **state)
{
    (void)state;
    double errors[2];
    for (int k = 0; k < 2; k++) {
        const int steps = 4 << k;
        double end;
        double between;
        swing(steps, &end, &between);
        // the truth at the same time: steps of which that time is an end
        Dop853 integrator;
        start_at(&integrator, 2.0);
        const double time = 2.0 - 0.3 * 2.0 / steps;
        for (int i = 0; i < 512; i++) {
            dop853_try(&integrator, time / 512);
            dop853_accept(&integrator);
        }
        errors[k] = fabs(between - integrator.y[0]);
        dop853_finish(&integrator);
    }
    assert_true(log2(errors[0] / errors[1]) > 6.5);
}

static void error_control_keeps_to_the_tolerance(void **state)
{
    (void)state;
    double last = 0.0;
    for (int digits = 4; digits <= 12; digits += 4) {
        Dop853 integrator;
        start_at(&integrator, 2.0);
        const double tolerance = pow(10.0, -digits);
        integrator.fixed[0] = integrator.fixed[1] = tolerance;
        integrator.step = 1.0;
        while (integrator.time < 20.0) {
            assert_true(dop853_attempt(&integrator, 20.0 - integrator.time));
            dop853_accept(&integrator);
        }
        const double energy = 0.5 * integrator.y[1] * integrator.y[1] - cos(integrator.y[0]);
        // some forty steps add up
        assert_near(energy, -cos(2.0), 100.0 * tolerance + 1e-14);
        assert_true((double)integrator.evaluations > last);
        last = (double)integrator.evaluations;
        dop853_finish(&integrator);
    }
}

static void the_polynomial_costs_nothing_where_nobody_asks_for_it(void **state)
{
    (void)state;
    Dop853 integrator;
    start_at(&integrator, 2.0);
    const size_t start = integrator.evaluations;
    dop853_try(&integrator, 0.25);
    dop853_accept(&integrator);
    assert_int_equal(integrator.evaluations - start, 12);
    dop853_try(&integrator, 0.25);
    const double early = dop853_dense(&integrator, 0.3)[0];
    assert_int_equal(integrator.evaluations - start, 12 + 15);
    // once a step, and of this step
    assert_true(early > dop853_dense(&integrator, 0.45)[0]);
    assert_true(dop853_dense(&integrator, 0.3)[0] == early);
    assert_near(dop853_dense(&integrator, 0.5)[0], integrator.next[0], 1e-15);
    dop853_accept(&integrator);
    assert_int_equal(integrator.evaluations - start, 12 + 15);
    dop853_try(&integrator, 0.25);
    assert_near(dop853_dense(&integrator, 0.5)[0], integrator.y[0], 0.0);
    assert_int_equal(integrator.evaluations - start, 12 + 15 + 15);
    dop853_finish(&integrator);
}

static void rates_at_the_end_that_are_known_are_not_worked_out_again(void **state)
{
    (void)state;
    Dop853 integrator;
    start_at(&integrator, 2.0);
    const size_t start = integrator.evaluations;
    dop853_try(&integrator, 0.25);
    pendulum(0.25, integrator.next, integrator.end_rates, NULL);
    integrator.has_end_rates = true;
    dop853_accept(&integrator);
    assert_int_equal(integrator.evaluations - start, 11);
    // control: the step after it begins with them
    Dop853 other;
    start_at(&other, 2.0);
    dop853_try(&other, 0.25);
    dop853_accept(&other);
    dop853_try(&integrator, 0.25);
    dop853_try(&other, 0.25);
    assert_true(integrator.next[0] == other.next[0] && integrator.next[1] == other.next[1]);
    assert_true(integrator.next[0] != integrator.y[0]);
    dop853_finish(&other);
    dop853_finish(&integrator);
}

static void what_is_not_finite(double time, const double *y, double *rates, void *context)
{
    (void)y;
    (void)context;
    rates[0] = time > 0.5 ? NAN : 1.0;
}

static void a_right_hand_side_that_ends_stops_the_integrator(void **state)
{
    (void)state;
    Dop853 integrator;
    dop853_init(&integrator, 1, 1);
    integrator.rates = what_is_not_finite;
    integrator.step = 0.1;
    integrator.shortest = 1e-14;
    integrator.fixed[0] = 1e-9;
    dop853_start(&integrator, 0.0, integrator.y);
    bool goes_on = true;
    for (int i = 0; i < 1000 && goes_on; i++) {
        goes_on = dop853_attempt(&integrator, 1.0);
        if (goes_on) {
            dop853_accept(&integrator);
        }
    }
    assert_false(goes_on);
    assert_true(integrator.time <= 0.5);
    dop853_finish(&integrator);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_weights_integrate_polynomials_up_to_the_order),
        cmocka_unit_test(each_stage_stands_at_its_node),
        cmocka_unit_test(halving_the_step_divides_the_error_by_two_to_the_eighth),
        cmocka_unit_test(the_polynomial_is_as_good_as_the_steps_to_one_order),
        cmocka_unit_test(error_control_keeps_to_the_tolerance),
        cmocka_unit_test(the_polynomial_costs_nothing_where_nobody_asks_for_it),
        cmocka_unit_test(rates_at_the_end_that_are_known_are_not_worked_out_again),
        cmocka_unit_test(a_right_hand_side_that_ends_stops_the_integrator),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

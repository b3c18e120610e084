// Are the amplitudes at each order those of a sum of sines that is known?
//
// Sums of whole revolutions are exact but for rounding, so that the tolerance is that of some
// thousand additions. The controls: a phase changes nothing, a sine between whole orders is none of
// the run of one revolution, and one above half the sampling rate comes back at a lower order.
#include "close.h"
#include "made_run.h"
#include "mechanism.h"

#include "measure/spectrum.h"

static const double ROUNDING = 1e-11; // of amplitudes of some 10 rad/s from 3600 samples

static Scenario turning(double revolutions, size_t samples)
{
    Scenario scenario = mechanism_paper();
    scenario.run.revolutions = revolutions;
    scenario.run.samples = samples;
    return scenario;
}

static double wave(double order, double turns, double phase)
{
    return sin(2.0 * M_PI * order * turns + phase);
}

static double known(double turns)
{
    return 3.0 + 5.0 * wave(1.0, turns, 0.3) + 0.25 * wave(2.0, turns, 1.7) +
           0.002 * wave(17.0, turns, 2.5);
}

static double shifted(double turns)
{
    return 3.0 + 5.0 * wave(1.0, turns, -2.0) + 0.25 * wave(2.0, turns, 0.0) +
           0.002 * wave(17.0, turns, 0.1);
}

// At 2.5 times the crank's speed: it repeats every two revolutions.
static double between(double turns)
{
    return known(turns) + 0.7 * wave(2.5, turns, 0.4);
}

static void amplitudes_are_those_of_the_sines(void **state)
{
    (void)state;
    MadeOmega *const SIGNALS[] = {known, shifted, known, shifted};
    const size_t SAMPLES[] = {720, 720, 721, 722}; // of four, odd, and of two alone
    for (int i = 0; i < 4; i++) {
        Scenario scenario = turning(3.0, SAMPLES[i]);
        Trajectory *run = made_run(&scenario, SIGNALS[i]);
        const double amplitudes[] = {3.0, 5.0, 0.25, 0.0};
        for (size_t order = 0; order < 4; order++) {
            assert_near(spectrum_body_order(run, 1, order), amplitudes[order], ROUNDING);
        }
        assert_near(spectrum_body_order(run, 1, 17), 0.002, ROUNDING);
        // it repeats every revolution, of which the spectrum is one
        assert_near(spectrum_body_between(run, 1), 0.0, 0.0);
        trajectory_destroy(run);
        scenario_free(&scenario);
    }
}

static void what_lies_between_orders_is_found_there(void **state)
{
    (void)state;
    Scenario scenario = turning(6.0, 720);
    Trajectory *run = made_run(&scenario, between);
    const Sections sections = section_find(run);
    const Orders orders = spectrum_orders(&sections);
    assert_int_equal(sections.period, 2);
    assert_int_equal(orders.per_order, 2);
    assert_near(spectrum_order(&orders, 5), 2.5, 0.0);
    assert_near(spectrum_body_between(run, 1), 0.7, ROUNDING);
    assert_near(spectrum_body_order(run, 1, 1), 5.0, ROUNDING);
    trajectory_destroy(run);
    // the control: one revolution alone cannot tell it from what lies at whole orders
    Scenario whole = turning(1.0, 720);
    Trajectory *cut = made_run(&whole, between);
    assert_near(spectrum_body_between(cut, 1), 0.0, 0.0);
    assert_true(fabs(spectrum_body_order(cut, 1, 2) - 0.25) > 0.1);
    trajectory_destroy(cut);
    scenario_free(&whole);
    scenario_free(&scenario);
}

// The highest order stays below half the sampling rate; what is above it is folded: 17 of 24
// samples a revolution is seen at 24 - 17 = 7.
static void few_samples_fold_high_orders(void **state)
{
    (void)state;
    Scenario scenario = turning(1.0, 24);
    Trajectory *run = made_run(&scenario, known);
    const Sections sections = section_find(run);
    assert_int_equal(spectrum_orders(&sections).count, 12);
    assert_true(isnan(spectrum_body_order(run, 1, 12)));
    assert_near(spectrum_body_order(run, 1, 7), 0.002, ROUNDING);
    trajectory_destroy(run);
    scenario_free(&scenario);
}

static void less_than_a_revolution_has_no_spectrum(void **state)
{
    (void)state;
    Scenario scenario = turning(0.9, 720);
    Trajectory *run = made_run(&scenario, known);
    assert_true(isnan(spectrum_body_order(run, 1, 1)));
    assert_true(isnan(spectrum_body_between(run, 1)));
    trajectory_destroy(run);
    scenario_free(&scenario);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(amplitudes_are_those_of_the_sines),
        cmocka_unit_test(what_lies_between_orders_is_found_there),
        cmocka_unit_test(few_samples_fold_high_orders),
        cmocka_unit_test(less_than_a_revolution_has_no_spectrum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Are the amplitudes at each order those of a sum of sines that is known?
//
// Sums of whole revolutions are exact but for rounding, so that the tolerance is that of some
// thousand additions. The controls: a phase changes nothing, a sine between whole orders is none of
// the run of one revolution, and one above half the sampling rate comes back at a lower order.
#include "close.h"
#include "made_run.h"
#include "mechanism.h"

#include "base/lcg.h"
#include "measure/spectrum.h"

static const double ROUNDING = 1e-11; // of amplitudes of some 10 rad/s from 3600 samples

static Scenario turning_scenario(double revolutions, size_t samples)
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
        Scenario scenario = turning_scenario(3.0, SAMPLES[i]);
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
    Scenario scenario = turning_scenario(6.0, 720);
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
    Scenario whole = turning_scenario(1.0, 720);
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
    Scenario scenario = turning_scenario(1.0, 24);
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
    Scenario scenario = turning_scenario(0.9, 720);
    Trajectory *run = made_run(&scenario, known);
    assert_true(isnan(spectrum_body_order(run, 1, 1)));
    assert_true(isnan(spectrum_body_between(run, 1)));
    trajectory_destroy(run);
    scenario_free(&scenario);
}

// Pulses, as contacts make them: of Gauss's form their amplitudes are known,
//     a_k = 2 |sum of h s sqrt(2 pi) exp(-2 (pi k s)^2) exp(-2 pi i k m)|
// with heights h, widths s and middles m as shares of a turn. They are at least as wide as half the
// distance of two samples: of what is narrower samples know nothing.
enum { PULSES = 3, PULSE_SAMPLES = 360, TRAINS = 200 };

typedef struct Pulses {
    double heights[PULSES];
    double widths[PULSES];
    double middles[PULSES];
} Pulses;

// The pulses, or their derivative of the first or second order, at a share of a turn.
static double pulses_at(const Pulses *pulses, double turns, int derivative)
{
    double sum = 0.0;
    for (int i = 0; i < PULSES; i++) {
        for (int image = -1; image <= 1; image++) {
            const double width = pulses->widths[i];
            const double z = (turns - pulses->middles[i] - image) / width;
            const double value = pulses->heights[i] * exp(-0.5 * z * z);
            sum += derivative == 0   ? value
                   : derivative == 1 ? -value * z / width
                                     : value * (z * z - 1.0) / (width * width);
        }
    }
    return sum;
}

static double sample_pulses(const void *context, size_t sample)
{
    return pulses_at(context, (double)sample / PULSE_SAMPLES, 0);
}

static double sample_rates(const void *context, size_t sample)
{
    return pulses_at(context, (double)sample / PULSE_SAMPLES, 1);
}

static double sample_accelerations(const void *context, size_t sample)
{
    return pulses_at(context, (double)sample / PULSE_SAMPLES, 2);
}

static double pulse_amplitude(const Pulses *pulses, size_t order)
{
    double real = 0.0;
    double imaginary = 0.0;
    for (int i = 0; i < PULSES; i++) {
        const double k = (double)order;
        const double width = pulses->widths[i];
        const double height = pulses->heights[i] * width * sqrt(2.0 * M_PI) *
                              exp(-2.0 * M_PI * M_PI * k * k * width * width);
        real += height * cos(2.0 * M_PI * k * pulses->middles[i]);
        imaginary += height * sin(2.0 * M_PI * k * pulses->middles[i]);
    }
    return (order == 0 ? 1.0 : 2.0) * hypot(real, imaginary);
}

// The largest error of lines above the mean, whose truth is times the square of the frequency.
static double worst_line(const Pulses *pulses, const double *amplitudes, bool is_acceleration)
{
    double worst = 0.0;
    for (size_t k = 1; k <= SPECTRUM_ORDER_MAX; k++) {
        const double frequency = 2.0 * M_PI * (double)k;
        const double truth =
            pulse_amplitude(pulses, k) * (is_acceleration ? frequency * frequency : 1.0);
        worst = fmax(worst, fabs(amplitudes[k] - truth));
    }
    return worst;
}

// What samples cannot show is said, and accelerations from the signal itself have next to none of
// it. The control: accelerations that are sampled, which are off by a hundred times as much.
static void what_folds_into_lines_is_said(void **state)
{
    (void)state;
    const Orders orders = {.count = SPECTRUM_ORDER_MAX + 1,
                           .per_order = 1,
                           .revolutions = 1,
                           .samples = PULSE_SAMPLES};
    Spectrum spectrum = spectrum_begin(&orders);
    double lines[SPECTRUM_ORDER_MAX + 1];
    double found = 0.0;
    double sampled = 0.0;
    uint64_t seed = lcg_stirred(5);
    for (int train = 0; train < TRAINS; train++) {
        Pulses pulses;
        for (int i = 0; i < PULSES; i++) {
            pulses.heights[i] = 0.55 + 0.45 * lcg_draw(&seed);
            pulses.widths[i] = 6e-3 * exp(1.2 * lcg_draw(&seed));
            pulses.middles[i] = 0.5 + 0.3 * lcg_draw(&seed);
        }
        const double said = spectrum_find(&spectrum, sample_pulses, &pulses, lines);
        assert_true(worst_line(&pulses, lines, false) <= said + ROUNDING);
        const double said_of_second =
            spectrum_find_acceleration(&spectrum, sample_pulses, sample_rates, &pulses, 1.0, lines);
        const double own = worst_line(&pulses, lines, true);
        assert_true(own <= said_of_second + 1e-6);
        found = fmax(found, own);
        spectrum_find(&spectrum, sample_accelerations, &pulses, lines);
        sampled = fmax(sampled, worst_line(&pulses, lines, true));
    }
    assert_true(found < 1e-2 * sampled);
    spectrum_finish(&spectrum);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(amplitudes_are_those_of_the_sines),
        cmocka_unit_test(what_lies_between_orders_is_found_there),
        cmocka_unit_test(few_samples_fold_high_orders),
        cmocka_unit_test(less_than_a_revolution_has_no_spectrum),
        cmocka_unit_test(what_folds_into_lines_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Are spikes found where they are, and only there?
//
// Half a sine of height P and duration T: width at half height 2 T / 3, integral 2 P T / pi.
// P exp(-t^2 / (2 s^2)): width 2 sqrt(2 ln 2) s, integral sqrt(2 pi) s P.
#include "close.h"

#include "mechanism.h"

#include "analytic/fourbar_motion.h"
#include "run/spikes.h"

#include <stdlib.h>

static const double STEP = 1e-6;     // s
static const double HEIGHT = 1000.0; // of the first pulse; each is a tenth lower
static const double DURATION = 1e-4; // s, of each
static const double DISTANCE = 1e-3; // s, between their onsets

enum { PULSES = 5 };

typedef double Shape(double time_s);

// The integral of what is traced is summed up by the trapezoidal rule.
static Trace trace_shape(Shape *shape, double end_s)
{
    Trace trace = trace_start(0.0, SIZE_MAX);
    double sum = 0.0;
    double before = shape(0.0);
    for (int i = 0; i * STEP <= end_s; i++) {
        const double value = shape(i * STEP);
        sum += i > 0 ? 0.5 * STEP * (value + before) : 0.0;
        before = value;
        trace_add(&trace, i * STEP, value, sum);
    }
    trace_close(&trace);
    return trace;
}

static double pulse_height(int number)
{
    return HEIGHT * pow(0.9, number);
}

// Pulses that begin at 0.5, 1.5, ... ms, the odd ones downwards.
static double half_sines(double time_s)
{
    const int number = (int)floor(time_s / DISTANCE);
    const double phase = (time_s - number * DISTANCE - 0.5 * DISTANCE) / DURATION;
    if (number >= PULSES || phase <= 0.0 || phase >= 1.0) {
        return 0.0;
    }
    return (number % 2 == 0 ? 1.0 : -1.0) * pulse_height(number) * sin(M_PI * phase);
}

static double slow_swing(double time_s)
{
    return 20.0 * sin(2.0 * M_PI * time_s / 5e-3);
}

static double half_sines_on_a_swing(double time_s)
{
    return half_sines(time_s) + slow_swing(time_s);
}

static double gaussians(double time_s)
{
    const double sigma = 0.2 * DURATION;
    double sum = 0.0;
    for (int i = 0; i < PULSES; i++) {
        const double off = (time_s - (i + 0.5) * DISTANCE) / sigma;
        sum += pulse_height(i) * exp(-0.5 * off * off);
    }
    return sum;
}

// Upward pulses only, without a gap where u is zero: valleys between them are no spikes.
static double gaussians_above_ground(double time_s)
{
    return gaussians(time_s) - 1.0;
}

static void pulses_are_measured_as_their_closed_form_has_it(void **state)
{
    (void)state;
    Trace trace = trace_shape(half_sines, PULSES * DISTANCE);
    SignalSpike *spikes = NULL;
    assert_int_equal(spikes_find(&trace, 0.5 * HEIGHT, &spikes), PULSES);
    for (int i = 0; i < PULSES; i++) {
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        const double onset_s = (i + 0.5) * DISTANCE;
        assert_near(spikes[i].time_s, onset_s + 0.5 * DURATION, STEP);
        // the top of a half sine half a step off: 1 - cos(pi / 200) = 1.2e-4
        assert_close(spikes[i].value, sign * pulse_height(i), 1.3e-4);
        assert_close(spikes[i].prominence, pulse_height(i), 1.3e-4);
        // twice the trace's tolerance over the slope there, cos(30 deg) pi P / T, on two sides
        assert_near(spikes[i].width_s, 2.0 / 3.0 * DURATION,
                    4.0 * trace.tolerance * DURATION / (0.866 * M_PI * pulse_height(i)));
        assert_near(spikes[i].onset_s, onset_s, 1.5 * STEP);
        assert_near(spikes[i].end_s, onset_s + DURATION, 1.5 * STEP);
        // the corners are a step off: (pi / 100)^2 / 4, and the trapezoidal rule
        assert_close(spikes[i].impulse, sign * 2.0 / M_PI * pulse_height(i) * DURATION, 5e-4);
        assert_int_equal(spikes[i].joint, -1);
    }
    free(spikes);
    trace_finish(&trace);
}

static void a_slow_swing_below_changes_pulses_by_no_more_than_itself(void **state)
{
    (void)state;
    Trace trace = trace_shape(half_sines_on_a_swing, PULSES * DISTANCE);
    SignalSpike *spikes = NULL;
    assert_int_equal(spikes_find(&trace, 0.5 * HEIGHT, &spikes), PULSES);
    for (int i = 0; i < PULSES; i++) {
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        const double base = slow_swing((i + 0.5) * DISTANCE + 0.5 * DURATION);
        assert_near(spikes[i].value, sign * pulse_height(i) + base, 2.0);
        assert_close(spikes[i].width_s, 2.0 / 3.0 * DURATION, 0.03);
        // all of the signal counts, and knees are seen to a few steps
        assert_near(spikes[i].impulse,
                    sign * 2.0 / M_PI * pulse_height(i) * DURATION + base * DURATION,
                    0.01 * pulse_height(i) * DURATION);
        assert_true(spikes[i].end_s - spikes[i].onset_s < 1.2 * DURATION);
    }
    free(spikes);
    trace_finish(&trace);
}

static void gaussians_have_their_width_and_valleys_are_no_spikes(void **state)
{
    (void)state;
    const double sigma = 0.2 * DURATION;
    Shape *const shapes[2] = {gaussians, gaussians_above_ground};
    for (int k = 0; k < 2; k++) {
        Trace trace = trace_shape(shapes[k], PULSES * DISTANCE);
        SignalSpike *spikes = NULL;
        assert_int_equal(spikes_find(&trace, 0.1 * HEIGHT, &spikes), PULSES);
        for (int i = 0; i < PULSES; i++) {
            assert_near(spikes[i].value, pulse_height(i) - k, 0.1);
            assert_close(spikes[i].width_s, 2.0 * sqrt(2.0 * log(2.0)) * sigma, 4e-3);
            // the tails beyond the knees hold less than a hundredth
            assert_close(spikes[i].impulse, sqrt(2.0 * M_PI) * sigma * pulse_height(i), 1e-2);
        }
        free(spikes);
        trace_finish(&trace);
    }
}

static double noise(double time_s)
{
    // a value a step, from its bits
    unsigned bits = (unsigned)lround(time_s / STEP) * 2654435761u;
    bits ^= bits >> 15;
    bits *= 2246822519u;
    bits ^= bits >> 13;
    return 40.0 * ((double)bits / 4294967296.0 - 0.5);
}

static double noisy_half_sines(double time_s)
{
    return half_sines(time_s) + noise(time_s);
}

static void noise_below_the_threshold_is_no_spike(void **state)
{
    (void)state;
    Trace trace = trace_shape(noise, PULSES * DISTANCE);
    SignalSpike *spikes = NULL;
    assert_int_equal(spikes_find(&trace, 41.0, &spikes), 0);
    assert_null(spikes);
    // the control: a threshold that noise reaches
    assert_true(spikes_find(&trace, 10.0, &spikes) > 100);
    free(spikes);
    trace_finish(&trace);
    // nor does it break a pulse into several
    trace = trace_shape(noisy_half_sines, PULSES * DISTANCE);
    assert_int_equal(spikes_find(&trace, 0.5 * HEIGHT, &spikes), PULSES);
    for (int i = 0; i < PULSES; i++) {
        assert_near(fabs(spikes[i].value), pulse_height(i), 20.0);
        assert_close(spikes[i].width_s, 2.0 / 3.0 * DURATION, 0.1);
    }
    free(spikes);
    trace_finish(&trace);
}

static void the_threshold_is_the_least_prominence(void **state)
{
    (void)state;
    Trace trace = trace_shape(half_sines, PULSES * DISTANCE);
    for (int i = 0; i < PULSES; i++) {
        SignalSpike *spikes = NULL;
        assert_int_equal(spikes_find(&trace, 0.999 * pulse_height(i), &spikes), i + 1);
        free(spikes);
        assert_int_equal(spikes_find(&trace, 1.001 * pulse_height(i), &spikes), i);
        free(spikes);
    }
    trace_finish(&trace);
}

// Two peaks upon one pulse, 1000 and 800 high, with a valley of 600 between; then a flat one of
// 300.
static double mountain(double time_s)
{
    static const double TIMES[] = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0};
    static const double VALUES[] = {0.0, 100.0, 1000.0, 600.0, 800.0, 50.0, 300.0, 300.0, 0.0};
    const double place = time_s / DURATION;
    const int i = (int)fmin(floor(place), 7.0);
    return VALUES[i] + (place - TIMES[i]) * (VALUES[i + 1] - VALUES[i]);
}

static void a_top_beside_a_higher_one_stands_out_from_the_valley(void **state)
{
    (void)state;
    Trace trace = trace_shape(mountain, 8.0 * DURATION);
    SignalSpike *spikes = NULL;
    assert_int_equal(spikes_find(&trace, 150.0, &spikes), 3);
    assert_near(spikes[0].prominence, 1000.0, 1e-9);
    assert_near(spikes[1].prominence, 200.0, 1e-9);
    assert_near(spikes[2].prominence, 250.0, 1e-9);
    // half of 200 below 800: back to 700 on either side, 0.5 and 1 / 7.5 of a piece away
    assert_near(spikes[1].width_s, (0.5 + 1.0 / 7.5) * DURATION, 1e-9);
    // they share the valley and do not overlap
    assert_near(spikes[0].end_s, 3.0 * DURATION, 1e-9);
    assert_near(spikes[1].onset_s, 3.0 * DURATION, 1e-9);
    assert_near(spikes[1].end_s, 5.0 * DURATION, 1e-9);
    assert_near(spikes[1].impulse, (700.0 + 425.0) * DURATION, 1e-3 * DURATION);
    assert_true(spikes[2].onset_s >= spikes[1].end_s);
    free(spikes);
    assert_int_equal(spikes_find(&trace, 201.0, &spikes), 2);
    free(spikes);
    trace_finish(&trace);
}

// A top, a shoulder that has fallen by half and risen again, and ground for long.
static double top_with_a_shoulder(double time_s)
{
    static const double VALUES[] = {0.0, 1000.0, 480.0, 760.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    const double place = time_s / DURATION;
    const int i = (int)fmin(floor(place), 7.0);
    return VALUES[i] + (place - i) * (VALUES[i + 1] - VALUES[i]);
}

static void a_spike_ends_where_its_signal_rises_again(void **state)
{
    (void)state;
    Trace trace = trace_shape(top_with_a_shoulder, 8.0 * DURATION);
    SignalSpike *spikes = NULL;
    // the shoulder stands out by 280, too little for a spike
    assert_int_equal(spikes_find(&trace, 450.0, &spikes), 1);
    assert_near(spikes[0].end_s, 2.0 * DURATION, 1e-9);
    assert_near(spikes[0].impulse, (500.0 + 740.0) * DURATION, 1e-3 * DURATION);
    free(spikes);
    trace_finish(&trace);
}

static double coupler_alpha(double time_s)
{
    const Scenario scenario = mechanism_paper();
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    return fourbar_motion_quantity(&lengths, scenario.linkage.driver.speed, FOURBAR_COUPLER_ALPHA,
                                   scenario.linkage.driver.speed * time_s * 100.0);
}

static void ideal_joints_show_no_spike(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const SpikeScale scale = spike_scale(&scenario);
    assert_true(scale.is_known);
    // the follower's, from PAPER's table of extremes: 12485.5 + 7512.3; a degree's grid is below
    assert_in_range((int)scale.alpha, 19950, 19998);
    assert_near(scale.force, 1566.2, 1.0);
    // three turns, a hundred times as fast in time so that they take few steps
    Trace trace = trace_shape(coupler_alpha, 3.0 * linkage_period(&scenario.linkage) / 100.0);
    SignalSpike *spikes = NULL;
    assert_int_equal(spikes_find(&trace, scale.alpha, &spikes), 0);
    // the control: a third of it is exceeded by the motion itself
    assert_true(spikes_find(&trace, scale.alpha / 3.0, &spikes) > 0);
    free(spikes);
    trace_finish(&trace);
}

static void the_scale_of_a_linkage_of_bodies_is_that_of_the_four_bar(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    const SpikeScale closed = spike_scale(&scenario);
    scenario.has_fourbar = false;
    const SpikeScale solved = spike_scale(&scenario);
    assert_true(solved.is_known);
    assert_close(solved.alpha, closed.alpha, 1e-9);
    assert_close(solved.force, closed.force, 1e-9);
    // nothing is known where nothing drives, or where the forces are not determined
    Scenario pin = mechanism_pin(0.1, 1e-3);
    assert_false(spike_scale(&pin).is_known);
    Scenario redundant = mechanism_parallelogram();
    assert_false(spike_scale(&redundant).is_known);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pulses_are_measured_as_their_closed_form_has_it),
        cmocka_unit_test(a_slow_swing_below_changes_pulses_by_no_more_than_itself),
        cmocka_unit_test(gaussians_have_their_width_and_valleys_are_no_spikes),
        cmocka_unit_test(noise_below_the_threshold_is_no_spike),
        cmocka_unit_test(the_threshold_is_the_least_prominence),
        cmocka_unit_test(a_top_beside_a_higher_one_stands_out_from_the_valley),
        cmocka_unit_test(a_spike_ends_where_its_signal_rises_again),
        cmocka_unit_test(ideal_joints_show_no_spike),
        cmocka_unit_test(the_scale_of_a_linkage_of_bodies_is_that_of_the_four_bar),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

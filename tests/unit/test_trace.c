// Does a trace tell what the signal did, in few points?
#include "close.h"

#include "run/spikes.h"

#include <stdlib.h>

enum { COUNT = 20000 };

// A swing of changing height with noise upon it, and its integral by the trapezoidal rule.
static void make_signal(double noise, double *times, double *values, double *integrals)
{
    unsigned state = 1;
    double sum = 0.0;
    for (int i = 0; i < COUNT; i++) {
        state = state * 1664525u + 1013904223u;
        const double random = (double)(state >> 8) / (1 << 24) - 0.5;
        times[i] = 1e-3 * i;
        values[i] = sin(0.7 * times[i]) * sin(31.0 * times[i]) + noise * random;
        sum += i > 0 ? 0.5e-3 * (values[i] + values[i - 1]) : 0.0;
        integrals[i] = sum;
    }
}

// The largest distance of the values from the trace's broken line.
static double distance(const Trace *trace, const double *times, const double *values)
{
    double largest = 0.0;
    size_t next = 1;
    for (int i = 0; i < COUNT; i++) {
        while (next + 1 < trace->count && trace->points[next].time_s < times[i]) {
            next++;
        }
        const TracePoint *a = &trace->points[next - 1];
        const TracePoint *b = &trace->points[next];
        const double share = (times[i] - a->time_s) / (b->time_s - a->time_s);
        largest = fmax(largest, fabs(a->value + share * (b->value - a->value) - values[i]));
    }
    return largest;
}

typedef struct Signal {
    double times[COUNT];
    double values[COUNT];
    double integrals[COUNT];
    Trace trace;
} Signal;

static Signal *trace_signal(double noise, size_t limit)
{
    Signal *signal = calloc(1, sizeof *signal);
    assert_non_null(signal);
    make_signal(noise, signal->times, signal->values, signal->integrals);
    signal->trace = trace_start(0.0, limit);
    for (int i = 0; i < COUNT; i++) {
        trace_add(&signal->trace, signal->times[i], signal->values[i], signal->integrals[i]);
    }
    trace_close(&signal->trace);
    return signal;
}

static void finish(Signal *signal)
{
    trace_finish(&signal->trace);
    free(signal);
}

// The number of a time among the signal's.
static int place_of(double time_s)
{
    return (int)lround(time_s / 1e-3);
}

static void a_trace_stays_near_every_value_in_few_points(void **state)
{
    (void)state;
    Signal *signal = trace_signal(0.0, SIZE_MAX);
    const Trace *trace = &signal->trace;
    assert_true(distance(trace, signal->times, signal->values) <= 2.0 * trace->tolerance);
    assert_close(trace->tolerance, 1e-3 * trace->largest, 1e-12);
    // 200 half swings, at most some 30 points each
    assert_in_range(trace->count, 600, 6000);
    // the points are the signal's own, with its integral
    for (size_t i = 0; i < trace->count; i++) {
        const int place = place_of(trace->points[i].time_s);
        assert_true(trace->points[i].value == signal->values[place]);
        assert_true(trace->points[i].integral == signal->integrals[place]);
    }
    finish(signal);
}

static void a_trace_goes_through_the_extremes(void **state)
{
    (void)state;
    Signal *signal = trace_signal(0.0, SIZE_MAX);
    // every maximum of the signal that stands out by more than the tolerance
    size_t next = 0;
    int passed = 0;
    for (int i = 40; i + 40 < COUNT; i++) {
        const double *value = &signal->values[i];
        const bool is_peak = value[0] > value[-1] && value[0] > value[1] &&
                             value[0] - fmax(value[-40], value[40]) > 4e-3;
        while (is_peak && signal->trace.points[next].time_s < signal->times[i]) {
            next++;
        }
        passed += is_peak ? 1 : 0;
        assert_true(!is_peak || signal->trace.points[next].time_s == signal->times[i]);
    }
    assert_in_range(passed, 80, 200);
    finish(signal);
}

static void too_many_points_are_thinned_and_the_tolerance_says_so(void **state)
{
    (void)state;
    Signal *signal = trace_signal(0.05, 1000);
    Signal *free_signal = trace_signal(0.05, SIZE_MAX);
    const Trace *trace = &signal->trace;
    assert_true(free_signal->trace.count > 1000);
    assert_true(trace->count <= 1000);
    assert_true(trace->coarseness >= 2.0);
    assert_close(trace->tolerance, 1e-3 * trace->coarseness * trace->largest, 1e-12);
    // thinned once more at twice the tolerance each time: 2 E (1 + 1/2 + 1/4 + ...)
    assert_true(distance(trace, signal->times, signal->values) <= 4.0 * trace->tolerance);
    finish(signal);
    finish(free_signal);
}

static void a_floor_holds_the_tolerance_up(void **state)
{
    (void)state;
    Trace trace = trace_start(0.1, SIZE_MAX);
    for (int i = 0; i < COUNT; i++) {
        // less than half of the floor: a line along the middle passes all
        trace_add(&trace, i, 0.045 * sin(0.1 * i), 0.0);
    }
    trace_close(&trace);
    assert_true(trace.tolerance == 0.1);
    assert_in_range(trace.count, 2, 8);
    trace_finish(&trace);
}

static void a_jump_keeps_both_of_its_values(void **state)
{
    (void)state;
    Trace trace = trace_start(0.0, SIZE_MAX);
    for (int i = 0; i <= 10; i++) {
        trace_add(&trace, i, 0.0, 0.0);
    }
    for (int i = 10; i <= 20; i++) {
        trace_add(&trace, i, 5.0, 5.0 * (i - 10));
    }
    trace_close(&trace);
    assert_int_equal(trace.count, 4);
    assert_near(trace.points[1].time_s, 10.0, 0.0);
    assert_near(trace.points[1].value, 0.0, 0.0);
    assert_near(trace.points[2].time_s, 10.0, 0.0);
    assert_near(trace.points[2].value, 5.0, 0.0);
    assert_near(trace.points[3].integral, 50.0, 0.0);
    trace_finish(&trace);
}

static void what_is_not_finite_does_not_hang(void **state)
{
    (void)state;
    Trace trace = trace_start(0.0, 8);
    for (int i = 0; i < 100; i++) {
        trace_add(&trace, i, i % 3 == 0 ? NAN : i % 3 == 1 ? INFINITY : 1.0, 0.0);
    }
    trace_close(&trace);
    trace_finish(&trace);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_trace_stays_near_every_value_in_few_points),
        cmocka_unit_test(a_trace_goes_through_the_extremes),
        cmocka_unit_test(too_many_points_are_thinned_and_the_tolerance_says_so),
        cmocka_unit_test(a_floor_holds_the_tolerance_up),
        cmocka_unit_test(a_jump_keeps_both_of_its_values),
        cmocka_unit_test(what_is_not_finite_does_not_hang),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

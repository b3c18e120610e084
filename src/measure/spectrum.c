// Finds the amplitudes of a run's signals by order.
//
// The samples of whole revolutions are equally far apart and the drive's period holds a whole
// number of them, so that the sums of a discrete Fourier transform at whole lines are exact: no
// window is needed, and nothing leaks from one order into another of a motion that repeats.
#include "measure/spectrum.h"

#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>

Orders spectrum_orders(const Sections *sections)
{
    Orders orders = {0};
    if (sections->count < 2) {
        return orders;
    }
    const size_t all = sections->count - 1;
    const size_t most = all < SPECTRUM_REVOLUTION_MAX ? all : SPECTRUM_REVOLUTION_MAX;
    // whole periods, where there is one; one period says as much as many
    const size_t period = sections->period;
    orders.revolutions = period > 0 ? period : most;
    orders.per_order = orders.revolutions;
    orders.samples = orders.revolutions * sections->stride;
    orders.first = section_sample(sections, all - orders.revolutions);
    // below half the sampling rate
    const size_t highest = (orders.samples - 1) / 2;
    const size_t wanted = SPECTRUM_ORDER_MAX * orders.per_order;
    orders.count = 1 + (wanted < highest ? wanted : highest);
    return orders;
}

// The cosines and sines of a whole turn in so many parts, in turn.
static double *turn_of(size_t parts)
{
    double *turn = zeroed(2 * parts, sizeof *turn);
    for (size_t n = 0; n < parts; n++) {
        const double angle = 2.0 * M_PI * (double)n / (double)parts;
        turn[2 * n] = cos(angle);
        turn[2 * n + 1] = sin(angle);
    }
    return turn;
}

static double amplitude_at(size_t line, const double *values, const double *turn, size_t samples)
{
    double real = 0.0;
    double imaginary = 0.0;
    for (size_t n = 0, at = 0; n < samples; n++) {
        real += values[n] * turn[2 * at];
        imaginary += values[n] * turn[2 * at + 1];
        at += line;
        at -= at >= samples ? samples : 0;
    }
    return line == 0 ? real / (double)samples : 2.0 * hypot(real, imaginary) / (double)samples;
}

static double *signal_values(const Orders *orders, SpectrumSignal *signal, const void *context)
{
    double *values = zeroed(orders->samples, sizeof *values);
    for (size_t n = 0; n < orders->samples; n++) {
        values[n] = signal(context, orders->first + n);
    }
    return values;
}

void spectrum_find(const Orders *orders, SpectrumSignal *signal, const void *context,
                   double *amplitudes)
{
    double *values = signal_values(orders, signal, context);
    double *turn = turn_of(orders->samples);
    for (size_t k = 0; k < orders->count; k++) {
        amplitudes[k] = amplitude_at(k, values, turn, orders->samples);
    }
    free(turn);
    free(values);
}

// The angular velocity of one body.

typedef struct BodySignal {
    const Trajectory *run;
    size_t body;
} BodySignal;

static double omega_of(const void *context, size_t sample)
{
    const BodySignal *signal = context;
    return trajectory_motion(signal->run, sample, signal->body)->omega;
}

double spectrum_body_order(const Trajectory *run, size_t body, size_t order)
{
    const Sections sections = section_find(run);
    const Orders orders = spectrum_orders(&sections);
    const size_t line = order * orders.per_order;
    if (line >= orders.count) {
        return NAN;
    }
    const BodySignal signal = {run, body};
    double *values = signal_values(&orders, omega_of, &signal);
    double *turn = turn_of(orders.samples);
    const double amplitude = amplitude_at(line, values, turn, orders.samples);
    free(turn);
    free(values);
    return amplitude;
}

double spectrum_body_between(const Trajectory *run, size_t body)
{
    const Sections sections = section_find(run);
    const Orders orders = spectrum_orders(&sections);
    if (orders.count == 0 || orders.per_order == 1) {
        return orders.count == 0 ? NAN : 0.0;
    }
    double *amplitudes = zeroed(orders.count, sizeof *amplitudes);
    spectrum_find(&orders, omega_of, &(BodySignal){run, body}, amplitudes);
    double most = 0.0;
    for (size_t k = 0; k < orders.count; k++) {
        most = k % orders.per_order != 0 ? fmax(most, amplitudes[k]) : most;
    }
    free(amplitudes);
    return most;
}

// Finds the amplitudes of a run's signals by order.
//
// The samples of whole revolutions are equally far apart and the drive's period holds a whole
// number of them, so that the sums of a discrete Fourier transform at whole lines are exact: no
// window is needed, and nothing leaks from one order into another of a motion that repeats.
//
// With N samples, half of which is H, waves of even lines are the same H samples later, those of
// odd lines the opposite; and within that half the cosine of an even line is the same backwards and
// its sine the opposite, of an odd line the other way round. So where N is even each line is a sum
// over a quarter of the samples, of x_n +- x_(n+H) and the same of H - n, which are added up once.
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

// Terms of a line's sum.
static size_t term_count(const Orders *orders)
{
    return orders->samples % 2 == 0 ? orders->samples / 4 + 1 : orders->samples;
}

Spectrum spectrum_begin(const Orders *orders)
{
    return (Spectrum){
        .orders = *orders,
        .turn = turn_of(orders->samples),
        .values = zeroed(orders->samples, sizeof(double)),
        .folded = zeroed(4 * term_count(orders), sizeof(double)),
    };
}

void spectrum_finish(Spectrum *spectrum)
{
    free(spectrum->turn);
    free(spectrum->values);
    free(spectrum->folded);
}

// What cosines, or sines, of even lines, or odd ones, are multiplied by.
static double *terms_of(const Spectrum *spectrum, bool is_odd, bool is_sine)
{
    if (spectrum->orders.samples % 2 == 1) {
        return spectrum->values;
    }
    return spectrum->folded +
           ((is_odd ? 2 : 0) + (is_sine ? 1 : 0)) * term_count(&spectrum->orders);
}

// Of even lines, or odd ones: the sums of two values that lie half of all samples apart, or their
// differences, and these with those that lie as far from the end of that half.
static void fold(Spectrum *spectrum, bool is_odd)
{
    const size_t half = spectrum->orders.samples / 2;
    const double *values = spectrum->values;
    const double sign = is_odd ? -1.0 : 1.0;
    double *cosines = terms_of(spectrum, is_odd, false);
    double *sines = terms_of(spectrum, is_odd, true);
    cosines[0] = values[0] + sign * values[half];
    for (size_t n = 1; 2 * n <= half; n++) {
        const double one = values[n] + sign * values[n + half];
        const size_t mirror = half - n;
        const double other = mirror > n ? values[mirror] + sign * values[mirror + half] : 0.0;
        cosines[n] = one + sign * other;
        sines[n] = one - sign * other;
    }
}

static void fold_signal(Spectrum *spectrum)
{
    if (spectrum->orders.samples % 2 == 0) {
        fold(spectrum, false);
        fold(spectrum, true);
    }
}

static void take_signal(Spectrum *spectrum, SpectrumSignal *signal, const void *context)
{
    for (size_t n = 0; n < spectrum->orders.samples; n++) {
        spectrum->values[n] = signal(context, spectrum->orders.first + n);
    }
    fold_signal(spectrum);
}

static double amplitude_at(const Spectrum *spectrum, size_t line)
{
    const size_t samples = spectrum->orders.samples;
    const size_t count = term_count(&spectrum->orders);
    const double *cosines = terms_of(spectrum, line % 2 == 1, false);
    const double *sines = terms_of(spectrum, line % 2 == 1, true);
    double real = 0.0;
    double imaginary = 0.0;
    for (size_t n = 0, at = 0; n < count; n++) {
        real += cosines[n] * spectrum->turn[2 * at];
        imaginary += sines[n] * spectrum->turn[2 * at + 1];
        at += line;
        at -= at >= samples ? samples : 0;
    }
    return line == 0 ? real / (double)samples : 2.0 * hypot(real, imaginary) / (double)samples;
}

static void find_amplitudes(const Spectrum *spectrum, double *amplitudes)
{
    for (size_t k = 0; k < spectrum->orders.count; k++) {
        amplitudes[k] = amplitude_at(spectrum, k);
    }
}

// The largest amplitude of the lines below a share of the sampling rate, as many as are looked at.
static double largest_below(const Spectrum *spectrum, size_t parts)
{
    const size_t last = spectrum->orders.samples / parts;
    double largest = 0.0;
    for (size_t k = 1; k <= spectrum->orders.count && k < last; k++) {
        largest = fmax(largest, amplitude_at(spectrum, last - k));
    }
    return largest;
}

// What may be folded into a line from either side of the sampling rate.
static double find_folded(const Spectrum *spectrum)
{
    const double half = largest_below(spectrum, 2);
    const double quarter = largest_below(spectrum, 4);
    return quarter > 0.0 ? 2.0 * half * fmin(1.0, half / quarter) : 2.0 * half;
}

double spectrum_find(Spectrum *spectrum, SpectrumSignal *signal, const void *context,
                     double *amplitudes)
{
    take_signal(spectrum, signal, context);
    find_amplitudes(spectrum, amplitudes);
    return find_folded(spectrum);
}

double spectrum_find_acceleration(Spectrum *spectrum, SpectrumSignal *signal, SpectrumSignal *rate,
                                  const void *context, double span_s, double *amplitudes)
{
    const Orders *orders = &spectrum->orders;
    const size_t first = orders->first;
    const size_t end = first + orders->samples;
    // the parabola b t + c t^2
    const double c = (rate(context, end) - rate(context, first)) / (2.0 * span_s);
    const double b = (signal(context, end) - signal(context, first)) / span_s - c * span_s;
    const double start = signal(context, first);
    for (size_t n = 0; n < orders->samples; n++) {
        const double time_s = span_s * (double)n / (double)orders->samples;
        spectrum->values[n] = signal(context, first + n) - start - time_s * (b + c * time_s);
    }
    fold_signal(spectrum);
    find_amplitudes(spectrum, amplitudes);
    amplitudes[0] = 2.0 * c;
    double square = 0.0;
    for (size_t k = 1; k < orders->count; k++) {
        const double frequency = 2.0 * M_PI * (double)k / span_s;
        square = frequency * frequency;
        amplitudes[k] *= square;
    }
    return square * find_folded(spectrum);
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
    Spectrum spectrum = spectrum_begin(&orders);
    take_signal(&spectrum, omega_of, &(BodySignal){run, body});
    const double amplitude = amplitude_at(&spectrum, line);
    spectrum_finish(&spectrum);
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
    Spectrum spectrum = spectrum_begin(&orders);
    spectrum_find(&spectrum, omega_of, &(BodySignal){run, body}, amplitudes);
    spectrum_finish(&spectrum);
    double most = 0.0;
    for (size_t k = 0; k < orders.count; k++) {
        most = k % orders.per_order != 0 ? fmax(most, amplitudes[k]) : most;
    }
    free(amplitudes);
    return most;
}

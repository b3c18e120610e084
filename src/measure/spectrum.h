// The spectra of a run by order: amplitudes at multiples of the crank's speed.
//
// Order k is k oscillations a revolution, a period of the drive. Between whole orders there is
// something only where the motion does not repeat every revolution: at multiples of 1/p of one that
// repeats after p.
#pragma once

#include "measure/section.h"

// The highest order that is looked at; revolutions that a motion which does not repeat is looked at
// over, at most, and so the finest distance of its orders.
enum { SPECTRUM_ORDER_MAX = 20, SPECTRUM_REVOLUTION_MAX = 16 };

// The orders of a run: whole multiples of 1 / `per_order`.
typedef struct Orders {
    size_t count;       // 0: there is no whole revolution of samples, or no drive with a period
    size_t per_order;   // lines from one whole order to the next
    size_t revolutions; // that it is taken over: the last whole ones of the run
    size_t first;       // sample that these begin at
    size_t samples;     // in them
} Orders;

// Those of a run with these sections.
Orders spectrum_orders(const Sections *sections);

static inline double spectrum_order(const Orders *orders, size_t line)
{
    return (double)line / (double)orders->per_order;
}

// A signal of a run at a sample.
typedef double SpectrumSignal(const void *context, size_t sample);

// What the spectra of several signals of one run share: waves of all orders, and room.
typedef struct Spectrum {
    Orders orders;
    double
        *turn; // cosines and sines of a whole turn in as many parts as there are samples, in turn
    double *values; // of a signal at the samples
    double *folded; // what waves are multiplied by: of even lines cosines, then sines; of odd ones
} Spectrum;

// For spectrum_finish.
Spectrum spectrum_begin(const Orders *orders);
void spectrum_finish(Spectrum *spectrum);

// The amplitudes of a signal, one an order: of order 0 its mean, of any other
//     a_k = (2 / N) |sum over n of x_n exp(-2 pi i k n / M)|
// with M samples a revolution and N in all. What the signal has above half the sampling rate is
// folded into lower orders: by up to the value that is returned, as far as the amplitudes next to a
// half and a quarter of that rate tell, which are taken to go on falling as between these.
double spectrum_find(Spectrum *spectrum, SpectrumSignal *signal, const void *context,
                     double *amplitudes);

// The same of the second derivative of a signal with a rate: of x less the parabola that makes x
// and its rate end as they began, times the square of each frequency. What is folded was first
// divided by the square of its own, far higher one. `span_s` is the time of all samples.
double spectrum_find_acceleration(Spectrum *spectrum, SpectrumSignal *signal, SpectrumSignal *rate,
                                  const void *context, double span_s, double *amplitudes);

// The amplitude of a body's angular velocity at one whole order, rad/s; NAN where there is none.
double spectrum_body_order(const Trajectory *run, size_t body, size_t order);

// The largest amplitude of a body's angular velocity between whole orders, rad/s: 0 of a motion
// that repeats every revolution. NAN where there is no spectrum.
double spectrum_body_between(const Trajectory *run, size_t body);

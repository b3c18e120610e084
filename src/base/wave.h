// A sinusoid: what it adds at a time, over a while and on the average of one, without losing digits
// in the difference of two sines.
//
//     w(t) = A sin(r t + p)
//     w(t + s) - w(t) = 2 A cos(r t + p + r s / 2) sin(r s / 2)
#pragma once

#include "base/sinc.h"

#include <math.h>
#include <stdbool.h>

typedef struct Wave {
    double amplitude; // in the unit of the quantity
    double rate;      // rad/s, above 0; 0: there is no wave
    double phase;     // rad, of the sine at time zero
} Wave;

static inline bool wave_exists(const Wave *wave)
{
    return wave->rate > 0.0;
}

static inline double wave_at(const Wave *wave, double time_s)
{
    return wave->amplitude * sin(wave->rate * time_s + wave->phase);
}

// By how much it grows in a while after a time.
static inline double wave_growth(const Wave *wave, double from_s, double since_s)
{
    const double half = 0.5 * wave->rate * since_s;
    return 2.0 * wave->amplitude * cos(wave->rate * from_s + wave->phase + half) * sin(half);
}

// The mean between two times, which may be the same.
static inline double wave_mean(const Wave *wave, double from_s, double to_s)
{
    return wave_at(wave, 0.5 * (from_s + to_s)) * sinc(0.5 * wave->rate * (to_s - from_s));
}

// The wave whose rate of change this one is.
static inline Wave wave_integral(const Wave *wave)
{
    return (Wave){wave->amplitude / wave->rate, wave->rate, wave->phase - 0.5 * M_PI};
}

// s; INFINITY where there is no wave.
static inline double wave_period(const Wave *wave)
{
    return wave_exists(wave) ? 2.0 * M_PI / wave->rate : INFINITY;
}

// The same wave seen from a later time on, its phase within a turn.
static inline Wave wave_from(const Wave *wave, double time_s)
{
    Wave from = *wave;
    if (wave_exists(wave)) {
        from.phase = remainder(wave->phase + wave->rate * time_s, 2.0 * M_PI);
    }
    return from;
}

// When do the force and the depth of a contact stop growing?
//
//     F = F_el(d) (1 + chi d'/v0) + c d'
//     dF/dt = F_el' d' (1 + chi d'/v0) + (F_el chi / v0 + c) d''
// A maximum lies where such a rate turns from positive to negative; it is found on the polynomial
// of the step.
#include "reference/peaks.h"

#include "base/root.h"

#include <stdint.h>

// of a step: a maximum missed by so much is too low by half the square of it, 1e-10 of itself
static const double NARROW = 1e-5;

// how much higher than both its ends a part of a step can rise: it is a seventh of a swing or so
static const double OVERSHOOT = 1.5;

typedef struct Peak {
    const Stepper *stepper;
    SystemState *scratch;
    size_t contact;
    int which;
} Peak;

static double peak_rate(double time, void *context)
{
    const Peak *peak = context;
    const System *system = peak->stepper->system;
    double y[DOP853_SIZE_MAX];
    double values[2];
    double rates[2];
    dop853_dense(&peak->stepper->integrator, time, y);
    if (!system->kind->evaluate(system, time, y, peak->scratch)) {
        return NAN;
    }
    system->kind->peak(system, peak->scratch, peak->contact, values, rates);
    return rates[peak->which];
}

// Whether a maximum of one quantity lies between two times, and could be the largest of its
// contact.
static bool has_peak(const Peaks *peaks, size_t index, double rate, double value)
{
    return peaks->was_rising[index] && rate < 0.0 &&
           OVERSHOOT * fmax(value, peaks->last[index]) > peaks->largest[index];
}

// Takes note of where a contact is now.
static void leave(Peaks *peaks, size_t index, double rate, double value)
{
    peaks->was_rising[index] = rate > 0.0;
    peaks->last[index] = value;
    peaks->largest[index] = fmax(peaks->largest[index], value);
}

double peaks_next(Peaks *peaks, const Stepper *stepper, double start_s, double end_s,
                  const SystemState *state)
{
    const System *system = stepper->system;
    double earliest = end_s;
    size_t passed = SIZE_MAX;
    double rates[SYSTEM_CONTACT_MAX][2];
    double values[SYSTEM_CONTACT_MAX][2];
    for (size_t i = 0; i < system->contact_count; i++) {
        if (system->contacts[i].mode != CONTACT_PRESSING) {
            continue;
        }
        system->kind->peak(system, state, i, values[i], rates[i]);
        for (int which = 0; which < 2; which++) {
            const size_t index = 2 * i + (size_t)which;
            Peak peak = {stepper, peaks->scratch, i, which};
            double time = end_s;
            if (has_peak(peaks, index, rates[i][which], values[i][which]) &&
                root_find(peak_rate, &peak, start_s, end_s, NARROW * (end_s - start_s), &time) &&
                time < earliest && time > start_s) {
                earliest = time;
                passed = index;
            }
        }
    }
    if (passed != SIZE_MAX) {
        peaks->was_rising[passed] = false;
        return earliest;
    }
    for (size_t i = 0; i < system->contact_count; i++) {
        const bool is_pressing = system->contacts[i].mode == CONTACT_PRESSING;
        for (size_t which = 0; which < 2; which++) {
            const size_t index = 2 * i + which;
            if (is_pressing) {
                leave(peaks, index, rates[i][which], values[i][which]);
            } else {
                // the next contact begins with both rising from nothing
                peaks->was_rising[index] = true;
                peaks->last[index] = peaks->largest[index] = 0.0;
            }
        }
    }
    return end_s;
}

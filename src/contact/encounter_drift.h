// What an encounter with a drift has beyond one without.
#pragma once

#include "contact/encounter.h"

// Adds to a row's speed and place, from the impulses so far and the moments, of an encounter of so
// many rows. Inline: for every pose.
static inline void encounter_drift_add(const Encounter *encounter, size_t rows, size_t row,
                                       double time_s, const double *impulse, const double *moment,
                                       double *speed, double *place)
{
    const double *drift = encounter->drift + row * rows;
    const double *rate = encounter->mobility_rate + row * rows;
    const double *second = moment + rows;
    const double since_s = time_s - encounter->middle_s;
    const double bend = 0.5 * time_s * encounter->free_rate[row];
    *speed += bend * (time_s - 2.0 * encounter->middle_s);
    *place += bend * time_s * (time_s / 3.0 - encounter->middle_s);
    for (size_t k = 0; k < rows; k++) {
        const double other = rate[k] - drift[k]; // of the transpose
        *speed += since_s * rate[k] * impulse[k] + (drift[k] - other) * moment[k];
        *place += since_s * rate[k] * moment[k] - 2.0 * other * second[k];
    }
}

// The same for all rows: what the change of the free accelerations does, and what the impulses in
// one row do.
void encounter_drift_bend_all(const Encounter *encounter, double time_s, double *positions,
                              double *speeds);
void encounter_drift_add_all(const Encounter *encounter, size_t row, double time_s,
                             const double *impulse, const double *moment, double *positions,
                             double *speeds);

// What a row's acceleration has more, under forces, after impulses, likewise.
static inline double encounter_drift_acceleration(const Encounter *encounter, size_t rows,
                                                  size_t row, double time_s, const double *impulse,
                                                  const double *force)
{
    const double since_s = time_s - encounter->middle_s;
    double sum = since_s * encounter->free_rate[row];
    for (size_t k = 0; k < rows; k++) {
        sum += since_s * encounter->mobility_rate[row * rows + k] * force[k] +
               2.0 * encounter->drift[row * rows + k] * impulse[k];
    }
    return sum;
}

// What an encounter with a drift has beyond one without.
#pragma once

#include "contact/encounter.h"

// Adds to a row's speed and place, from the impulses so far and the moments.
void encounter_drift_add(const Encounter *encounter, size_t row, double time_s,
                         const double *impulse, const double *moment, double *speed, double *place);

// The same for all rows: what the change of the free accelerations does, and what the impulses in
// one row do.
void encounter_drift_bend_all(const Encounter *encounter, double time_s, double *positions,
                              double *speeds);
void encounter_drift_add_all(const Encounter *encounter, size_t row, double time_s,
                             const double *impulse, const double *moment, double *positions,
                             double *speeds);

// What a row's acceleration has more, under forces, after impulses.
double encounter_drift_acceleration(const Encounter *encounter, size_t row, double time_s,
                                    const double *impulse, const double *force);

// When does a pin that has left its wall meet it again?
#pragma once

#include "contact/encounter_force.h"

// The time until then, s, from a point at which nothing touches and the pin of a joint is at its
// wall, to rounding, and on its way off it; INFINITY where that is later than `left_s`. In closed
// form but for the root of a cubic: the pin moves under a constant acceleration.
double encounter_flight_time(const Encounter *encounter, size_t joint, const EncounterPoint *from,
                             double left_s);

// How large an error of an implicit step is.
#pragma once

#include "contact/encounter_force.h"

// Errors of the impulses, N s, and of their integrals, N s^2, at the end of a step, by row, over
// what is allowed; `moved` are the impulses in the step. Infinite or NaN where they are.
double encounter_error_share(const Encounter *encounter, const EncounterPoint *from, double width_s,
                             const double *moved, const double *impulse, const double *moment);

// What rounding leaves of a depth, m: the play less an eccentricity, or at a line the gap at the
// start of the world's step less the way since then.
double encounter_error_rounding(const Encounter *encounter, size_t joint, double time_s);

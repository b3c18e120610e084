// Local steps of an encounter whose contacts are damped so strongly that explicit steps would be
// unstable: an implicit method, and how long its steps are.
#pragma once

#include "contact/encounter_force.h"

// Whether the next step from a point has to be implicit, where an explicit one would have a length,
// s, and another if it were not for friction.
bool encounter_stiff_is_needed(const Encounter *encounter, const EncounterPoint *point,
                               double explicit_s, double frictionless_s);

// One implicit step from a completed point; the forces at its end are left open. Returns the
// estimate of its error over what is allowed, INFINITY where the equations are not solved, and then
// `to` is not to be used.
double encounter_stiff_step(Encounter *encounter, const EncounterPoint *from, double width_s,
                            EncounterPoint *to);

// The length of the step that follows one with an error.
double encounter_stiff_next(double width_s, double error);

// Writes the forces that the last step found at its start, left by what had died away at its first
// stage: a world's step begins beside the motion of the contact, by rounding or by its own error.
void encounter_stiff_settled(const Encounter *encounter, double *force);

void encounter_stiff_finish(Encounter *encounter);

// Local steps of an encounter, up to whatever happens in them.
#pragma once

#include "contact/encounter_force.h"

// Takes a step of at most `left_s` from a completed point, by the method that suits, and as long as
// that allows. Returns its length; the forces at its end are left open, as below.
double encounter_step_take(Encounter *encounter, const EncounterPoint *from, double left_s,
                           EncounterPoint *to);

// A step from there of a given length by the same method. Returns false where an implicit one
// cannot be solved; `to` is then near it at best.
bool encounter_step_try(Encounter *encounter, const EncounterPoint *from, double width_s,
                        EncounterPoint *to);

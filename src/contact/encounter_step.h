// Local steps of an encounter, up to whatever happens in them.
#pragma once

#include "contact/encounter_explicit.h"

typedef enum EncounterMethod {
    ENCOUNTER_FLIGHT, // nothing touches
    ENCOUNTER_EXPLICIT,
    ENCOUNTER_STIFF,
} EncounterMethod;

// A step that has been taken, or tried.
typedef struct EncounterStep {
    EncounterMethod method;
    bool is_ended;              // whether the forces at its end need not be evaluated
    const EncounterPoint *from; // completed: with forces and rates
    EncounterExplicit explicit;
} EncounterStep;

// Takes a step of at most `left_s` from a completed point, by the method that suits, and as long as
// that allows. Returns its length; the forces at its end are left open, as below.
double encounter_step_take(Encounter *encounter, EncounterStep *step, double left_s,
                           EncounterPoint *to);

// A step from there of a given length by the same method. Returns false where an implicit one
// cannot be solved; `to` is then near it at best.
bool encounter_step_try(Encounter *encounter, EncounterStep *step, double width_s,
                        EncounterPoint *to);

// The depth of a joint after a part of a step that was taken, m.
double encounter_step_depth(Encounter *encounter, EncounterStep *step, size_t joint,
                            double width_s);

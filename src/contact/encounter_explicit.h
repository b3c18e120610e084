// Explicit local steps of an encounter, which use the forces and their rates.
#pragma once

#include "contact/encounter_force.h"

// A step from a completed point: what it was made from, and where it leads.
typedef struct EncounterExplicit {
    int order; // 4 or 5
    double width_s;
    double middle;          // the share of the width at which the forces below are
    EncounterPoint *inside; // there, in the encounter's work
    bool extends;           // whether the forces at its end follow from it well enough
} EncounterExplicit;

// Takes a step of an order and length. Of its end all is written but the forces.
void encounter_explicit_step(Encounter *encounter, const EncounterPoint *from, int order,
                             double width_s, EncounterExplicit *step, EncounterPoint *to);

// Impulses and moments at a share of the step, 0 to 1, without any further evaluation: from the
// cubic through the forces and rates at the start and inside.
void encounter_explicit_inside(const Encounter *encounter, const EncounterExplicit *step,
                               const EncounterPoint *from, double share, double *impulse,
                               double *moment);

// Writes the forces and powers at the end of a step by the same cubic.
void encounter_explicit_extend(const Encounter *encounter, const EncounterExplicit *step,
                               const EncounterPoint *from, EncounterPoint *to);

// The error of a step over what is allowed, and how long the next step of either order may be, s,
// of the joint that allows the least.
double encounter_explicit_error(const Encounter *encounter, EncounterExplicit *step,
                                const EncounterPoint *from, double longest_s[2]);

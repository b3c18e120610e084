// Where in a local step do contacts begin and end?
#pragma once

#include "contact/encounter_step.h"

// Shortens a step to where the first contact begins or ends in it. Returns how many do there; which
// is in the encounter's work.
size_t encounter_events_find(Encounter *encounter, EncounterStep *step, const EncounterPoint *to,
                             double *width_s);

// Shortens a step in which a pin goes away from its wall and comes to it, while another one
// touches, to where it turns: from there on the next crossing can be found. Returns whether there
// is one.
bool encounter_events_shorten(const Encounter *encounter, const EncounterPoint *from,
                              const EncounterPoint *to, double *width_s);

// Steps to where the first of the contacts found begins or ends: the length is right but for the
// error of what was known between the ends of the step. Returns false where a step cannot be taken.
bool encounter_events_step(Encounter *encounter, EncounterStep *step, double *width_s,
                           EncounterPoint *to);

// The forces of an encounter with their derivatives in time, along the motion that is under way.
#pragma once

#include "contact/encounter_force.h"

// Writes the forces in all rows, their rates, N/s, the powers lost in damping and in friction, and
// the rates of these, W/s: of a point of which time, impulses and moments are given.
void encounter_rates_find(Encounter *encounter, EncounterPoint *point);

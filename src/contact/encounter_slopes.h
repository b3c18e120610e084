// How the force of a contact in an encounter changes with position and speed of its rows.
#pragma once

#include "contact/encounter_force.h"

typedef struct EncounterSlopes {
    double force[ENCOUNTER_ROWS_MOST];                         // N, N m
    double by_place[ENCOUNTER_ROWS_MOST][2];                   // N/m, of the first two rows
    double by_speed[ENCOUNTER_ROWS_MOST][ENCOUNTER_ROWS_MOST]; // N s/m
} EncounterSlopes;

// Writes force and derivatives of one joint, all zero where it does not touch. With `from_depth` 0,
// m, the force is that of encounter_force_find, which never pulls. Above 0 it is smooth instead: it
// goes on linearly below that depth, and the damper may pull.
void encounter_slopes_find(const Encounter *encounter, size_t joint, double time_s,
                           const double *impulse, const double *moment, double from_depth,
                           EncounterSlopes *slopes);

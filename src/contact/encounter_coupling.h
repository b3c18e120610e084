// How the places of an encounter move each other.
#pragma once

#include "contact/encounter.h"

// Which places move which: those of place i are partners[first_partner[i]] up to before
// partners[first_partner[i + 1]], in order, itself among them; and the mobility between two of
// them, row by row, of the later one's rows from the other's.
typedef struct EncounterCoupling {
    const size_t *first_partner;
    const size_t *partners;
    const double *(*block)(const void *context, size_t place, size_t other);
    const void *context;
} EncounterCoupling;

// Writes the mobilities of an encounter that consists of some places, in order, or of all (NULL).
void encounter_fill(Encounter *encounter, const EncounterCoupling *coupling, const size_t *places);

// How far apart rows of an encounter of some places are at most that move each other.
size_t encounter_coupling_reach(const EncounterCoupling *coupling, const Encounter *encounter,
                                const size_t *places);

// How fast impulses that vary so in the rows of one place may make another one at most, m/s; both
// are joints of an encounter of all places.
double encounter_coupling_push(const EncounterCoupling *coupling, const Encounter *all, size_t from,
                               const double *variations, size_t to);

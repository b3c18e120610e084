// The stages of an implicit step of an encounter: Radau IIA of order 5.
#pragma once

#include "base/banded.h"
#include "contact/encounter_force.h"

enum { ENCOUNTER_STAGES = 3 };

// Times of the stages in the step, and how much of the forces at one counts at another; the last
// stage is the end of the step.
extern const double ENCOUNTER_NODE[ENCOUNTER_STAGES];
extern const double ENCOUNTER_COUPLING[ENCOUNTER_STAGES][ENCOUNTER_STAGES];

typedef struct EncounterStages {
    size_t count;                    // rows that touch
    size_t *row_of;                  // owned, as are all arrays
    double *from_depth;              // m, below which a smooth force is linear; by joint
    double *moved[ENCOUNTER_STAGES]; // N s: the impulses since the start, by row
    double *impulse[ENCOUNTER_STAGES];
    double *moment[ENCOUNTER_STAGES];
    double powers[ENCOUNTER_STAGES][2];
    // forces by row, and their derivatives by impulses and moments between rows that touch: at the
    // stages, and last at the start of the step, where the damper may pull
    double *forces[ENCOUNTER_STAGES + 1];
    Banded by_impulse[ENCOUNTER_STAGES + 1];
    Banded by_moment[ENCOUNTER_STAGES + 1];
    Banded matrix;  // Newton's, or that of an estimate
    double *change; // by unknown: what Newton's method changes
    double *changes[2];
} EncounterStages;

// Gives the encounter its stages.
void encounter_stages_create(Encounter *encounter);
void encounter_stages_destroy(EncounterStages *stages);

// Solves for the stages of a step of a length, s, from a completed point. Returns false where
// Newton's method does not get there.
bool encounter_stages_solve(Encounter *encounter, EncounterStages *stages,
                            const EncounterPoint *from, double width_s);

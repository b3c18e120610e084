// One island of contacts, or one block of a large one (contact/encounter_islands.h).
#pragma once

#include "contact/encounter_coupling.h"
#include "contact/encounter_input.h"

enum {
    ENCOUNTER_LARGE = 48, // active places of an island up to which it is not divided
    ENCOUNTER_BUSY = 24,  // events in a step of a larger one up to which it is not divided either
};

typedef struct EncounterIsland {
    Encounter encounter; // a joint of it is one of the places
    size_t *places;      // owned; in order
    bool is_run;         // in this step
    size_t node;         // of the time that was looked at last
    EncounterSums sums;  // then
    double look_s;
    // of a block of a larger island
    EncounterInput *input; // what the others do to it; NULL of one that never was a block
    bool *is_boundary;     // by joint: whether it moves places of others; owned
    double longest_s[2];   // of the next explicit and implicit step, as the step began
    double stiff_width_s;
} EncounterIsland;

typedef struct EncounterIslands {
    Encounter *all; // joints and rows of all places: what lives on from step to step
    EncounterCoupling coupling;
    size_t count;
    EncounterIsland **islands; // of this step; owned, as are all arrays
    EncounterIsland **kept;    // by place: the island that begins with it in this step or the last
    size_t *island_of;         // by place: its number, or `count`
    size_t *number_in;         // by place: which of its island's it is
    bool *is_active;           // by place
    double *pushes;            // m/s, by place: how fast others may make one that flies
    size_t *leaders;           // by place, of places that belong together
    double (*longest_s)[2];    // by place: of the next explicit step
    double duration_before_s;  // of the step before
    size_t undivided_most;     // active places of an island that is not divided, whatever happens
    size_t events_most;        // of a larger one, events in a step up to which it is not divided
    size_t *clusters;          // by place: which may be in one block
    size_t *parents;           // by place: the first of those that belong together
    bool *is_divided;          // by place: whether it is in a block of its island
    bool *is_to_divide;        // by place: whether its island had too many events in this step
    bool *is_kept_whole;       // by place: whether its blocks have not agreed in this step
    unsigned *waits;           // by place: steps in which its island is divided right away
    unsigned *patience;        // by place: how many of them there were the last time
    EncounterTrack *tracks;    // by place: what those of blocks do
} EncounterIslands;

// Makes an island of so many of the places, which it takes over.
EncounterIsland *encounter_island_make(const EncounterIslands *islands, size_t *places,
                                       size_t count);
void encounter_island_free(EncounterIsland *island);

// Gives an island the state of its places at the start of the step.
void encounter_island_start(const EncounterIslands *islands, EncounterIsland *island);

// Contacts of a mechanism with many places, integrated apart where they do not feel each other
// within a step: each island of places by itself, in local steps of its own.
//
// A place is active in a step if it touches in it, or may. Its impulses move its partners, the
// places with a mobility from it. An island is a set of active places that are connected so. All
// other places fly, pushed by their partners.
#pragma once

#include "contact/encounter_coupling.h"

typedef struct EncounterIsland {
    Encounter encounter; // a joint of it is one of the places
    size_t *places;      // owned; in order
    bool is_run;         // in this step
    size_t node;         // of the time that was looked at last
    EncounterSums sums;  // then
    double look_s;
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
} EncounterIslands;

// Prepares the islands of all places. Both are kept as pointers.
EncounterIslands *encounter_islands_create(Encounter *all, const EncounterCoupling *coupling);
void encounter_islands_destroy(EncounterIslands *islands);

// Integrates a step of a length, s, from the positions, speeds and free accelerations of all rows.
// Returns false where that takes too many local steps.
bool encounter_islands_run(EncounterIslands *islands, double duration);

// Looks at one island at a time in the step, s, behind one of its nodes.
void encounter_island_look(EncounterIsland *island, size_t node, double time_s);

// Looks at all of them, and writes the sums of all rows.
void encounter_islands_look(EncounterIslands *islands, double time_s, EncounterSums *sums);

// How a place is at a time at which its island was looked at last, or, if it flies, those of its
// partners, whose sums are given by row of all.
EncounterPose encounter_islands_pose(const EncounterIslands *islands, size_t place, double time_s,
                                     const EncounterSums *sums);

// Contacts of a mechanism with many places, integrated apart where they do not feel each other
// within a step: each island of places by itself, in local steps of its own.
//
// A place is active in a step if it touches in it, or may. Its impulses move its partners, the
// places with a mobility from it. An island is a set of active places that are connected so, or a
// block of one where that is large (contact/encounter_blocks.h). All other places fly, pushed by
// their partners.
#pragma once

#include "contact/encounter_island.h"

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

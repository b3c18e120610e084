// Islands of many places in blocks, each of which is integrated by itself under what the places of
// the others do to it, again and again until nothing changes any more.
#pragma once

#include "contact/encounter_island.h"

// The clusters that places are sorted into once and for all: those of one joint, and neighbours of
// neighbours. Owned by the caller.
size_t *encounter_blocks_cluster(const Encounter *all, const EncounterCoupling *coupling);

// Divides islands that are large: of places that belong together, those of one cluster stay so.
void encounter_blocks_divide(EncounterIslands *islands);

// Connects the islands that are blocks of a larger one with the tracks of the others.
void encounter_blocks_connect(EncounterIslands *islands);

// Begins a step: no track says anything.
void encounter_blocks_begin(EncounterIslands *islands);

// Runs an island through a step, from its start.
typedef bool EncounterRunIsland(EncounterIslands *islands, EncounterIsland *island,
                                double duration);

typedef enum EncounterBlocksEnd {
    ENCOUNTER_BLOCKS_DONE,
    ENCOUNTER_BLOCKS_ANEW,   // some island is to be divided, or not to be: make islands anew
    ENCOUNTER_BLOCKS_FAILED, // too many local steps
} EncounterBlocksEnd;

// Runs the islands that are not run yet, and blocks until they agree.
EncounterBlocksEnd encounter_blocks_run(EncounterIslands *islands, EncounterRunIsland *run,
                                        double duration);

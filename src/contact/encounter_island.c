// What does an island of contacts take from all places, and what is its own?
#include "contact/encounter_island.h"

#include "base/zeroed.h"

#include <math.h>
#include <string.h>

EncounterIsland *encounter_island_make(const EncounterIslands *islands, size_t *places,
                                       size_t count)
{
    const Encounter *all = islands->all;
    EncounterIsland *island = zeroed(1, sizeof *island);
    Encounter *encounter = &island->encounter;
    *encounter = encounter_start(all->phase);
    encounter->duration_before_s = islands->duration_before_s;
    island->places = places;
    for (size_t i = 0; i < count; i++) {
        const EncounterJoint *joint = &all->joints[places[i]];
        encounter_add(encounter, joint, joint->row_count);
        for (size_t k = 0; joint->is_touching && k < 2; k++) {
            encounter->longest_s[k] =
                fmin(encounter->longest_s[k], islands->longest_s[places[i]][k]);
        }
    }
    encounter_make_room(encounter, encounter_coupling_reach(&islands->coupling, encounter, places));
    island->sums = encounter_sums(encounter->row_count);
    return island;
}

void encounter_island_free(EncounterIsland *island)
{
    if (island != NULL) {
        encounter_finish(&island->encounter);
        encounter_sums_free(&island->sums);
        encounter_input_destroy(island->input);
        free(island->is_boundary);
        free(island->places);
        free(island);
    }
}

void encounter_island_start(const EncounterIslands *islands, EncounterIsland *island)
{
    const Encounter *all = islands->all;
    Encounter *encounter = &island->encounter;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const EncounterJoint *from = &all->joints[island->places[i]];
        EncounterJoint *joint = &encounter->joints[i];
        const size_t first = joint->first_row;
        const size_t size = joint->row_count * sizeof(double);
        *joint = *from;
        joint->first_row = first;
        memcpy(encounter->position + first, all->position + from->first_row, size);
        memcpy(encounter->speed + first, all->speed + from->first_row, size);
        memcpy(encounter->free + first, all->free + from->first_row, size);
    }
    encounter->duration_before_s = islands->duration_before_s;
    encounter_fill(encounter, &islands->coupling, island->places);
}

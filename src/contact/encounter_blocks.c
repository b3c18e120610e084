// How are many contacts that feel each other integrated, each in local steps of its own?
//
// Every contact that begins or ends cuts the local steps of an island, so that one of n places
// takes the time of n^2. What a place does to those next to it is, in a step,
//     u'' = g + W f + W_o f_o
// with f_o the forces of the places outside its block. Blocks are run one after the other under the
// f_o of the last run of each of the others (waveform relaxation, Gauss-Seidel), and again while
// one of these has changed by more than the local steps' tolerance. With w the frequency of a
// contact and h the step, k rounds leave (w h)^(2 k) / (2 k)! of the coupling: it converges
// for any h, and quickly for w h of a few rad. Where it takes too many rounds the island is run as
// a whole. Contacts of others that begin or end in the step end local steps of the block; smooth
// changes do not. So the answer is that of the whole, at other local steps.
//
// Source: Lelarasmee, Ruehli and Sangiovanni-Vincentelli, IEEE Trans. CAD 1 (1982) 131.
#include "contact/encounter_blocks.h"

#include "base/leaders.h"
#include "base/zeroed.h"

#include <string.h>

enum {
    CLUSTER = 4,        // places of a block at most, but for more of one joint
    ROUNDS_MOST = 40,   // after which an island is run as a whole
    PATIENCE_LEAST = 3, // steps in which an island is divided before it is tried as a whole again
    PATIENCE_MOST = 15,
};

// Adds a place with all of its joint to a cluster, and to the queue.
static void cluster_joint(const Encounter *all, size_t place, size_t cluster, size_t *cluster_of,
                          size_t *queue, size_t *queued)
{
    size_t first = place;
    while (first > 0 && all->joints[first - 1].joint == all->joints[place].joint) {
        first--;
    }
    for (size_t i = first; i < all->joint_count && all->joints[i].joint == all->joints[place].joint;
         i++) {
        cluster_of[i] = cluster;
        queue[(*queued)++] = i;
    }
}

size_t *encounter_blocks_cluster(const Encounter *all, const EncounterCoupling *coupling)
{
    const size_t count = all->joint_count;
    size_t *cluster_of = zeroed(count, sizeof *cluster_of);
    size_t *queue = zeroed(count, sizeof *queue);
    size_t queued = 0;
    size_t next = 0;
    size_t cluster = 0;
    size_t begun = 0; // places before those of the cluster
    memset(cluster_of, 0xff, count * sizeof *cluster_of);
    for (size_t start = 0; start < count; start++) {
        if (cluster_of[start] == SIZE_MAX) {
            cluster = queued > 0 ? cluster + 1 : 0;
            begun = queued;
            cluster_joint(all, start, cluster, cluster_of, queue, &queued);
        }
        for (; next < queued; next++) {
            const size_t *first = coupling->first_partner + queue[next];
            for (size_t n = first[0]; n < first[1]; n++) {
                const size_t partner = coupling->partners[n];
                if (cluster_of[partner] != SIZE_MAX) {
                    continue;
                }
                if (queued - begun >= CLUSTER) {
                    cluster++;
                    begun = queued;
                }
                cluster_joint(all, partner, cluster, cluster_of, queue, &queued);
            }
        }
    }
    free(queue);
    return cluster_of;
}

// Finds the places of islands that are large, and have or had too much going on.
static bool choose_divided(EncounterIslands *islands)
{
    const size_t count = islands->all->joint_count;
    size_t *sizes = zeroed(count, sizeof *sizes);
    bool is_any = false;
    for (size_t i = 0; i < count; i++) {
        islands->parents[i] = leaders_find(islands->leaders, i);
        sizes[islands->parents[i]] += islands->is_active[i] ? 1 : 0;
    }
    for (size_t i = 0; i < count; i++) {
        const size_t parent = islands->parents[i];
        islands->is_divided[i] = islands->is_active[i] && sizes[parent] > islands->undivided_most &&
                                 (islands->waits[parent] > 0 || islands->is_to_divide[parent]) &&
                                 !islands->is_kept_whole[parent];
        is_any = is_any || islands->is_divided[i];
    }
    free(sizes);
    return is_any;
}

void encounter_blocks_divide(EncounterIslands *islands)
{
    const EncounterCoupling *coupling = &islands->coupling;
    const size_t count = islands->all->joint_count;
    if (!choose_divided(islands)) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        islands->leaders[i] = islands->is_divided[i] ? i : islands->leaders[i];
    }
    for (size_t i = 0; i < count; i++) {
        for (size_t n = coupling->first_partner[i];
             islands->is_divided[i] && n < coupling->first_partner[i + 1]; n++) {
            const size_t partner = coupling->partners[n];
            if (islands->is_active[partner] && islands->clusters[partner] == islands->clusters[i]) {
                leaders_join(islands->leaders, i, partner);
            }
        }
    }
}

// Adds what one place outside does to a place of a block. Returns whether it is outside.
static bool connect_partner(EncounterIslands *islands, EncounterIsland *island, size_t number,
                            size_t partner)
{
    const EncounterCoupling *coupling = &islands->coupling;
    const size_t place = island->places[number];
    EncounterInput *input = island->input;
    if (!islands->is_active[partner] || islands->island_of[partner] == islands->island_of[place]) {
        return false;
    }
    const EncounterTrack *track = &islands->tracks[partner];
    size_t source = 0;
    while (source < input->source_count && input->sources[source] != track) {
        source++;
    }
    if (source == input->source_count) {
        encounter_input_add(input, track);
    }
    const EncounterJoint *joint = &island->encounter.joints[number];
    const EncounterLink link = {
        .source = source,
        .row = joint->first_row,
        .rows = joint->row_count,
        .mobility = coupling->block(coupling->context, place, partner),
        .is_transposed = place < partner,
    };
    encounter_input_link(input, &link);
    return true;
}

static void connect_block(EncounterIslands *islands, EncounterIsland *island)
{
    const EncounterCoupling *coupling = &islands->coupling;
    const size_t count = island->encounter.joint_count;
    if (island->input == NULL) {
        island->input = encounter_input_create(island->encounter.row_count);
        island->is_boundary = zeroed(count, sizeof *island->is_boundary);
    }
    EncounterInput *input = island->input;
    // versions of tracks that a block has been run with already
    const EncounterInput before = *input;
    input->sources = NULL;
    input->versions = NULL;
    input->source_room = input->version_room = 0;
    encounter_input_clear(input);
    for (size_t i = 0; i < count; i++) {
        const size_t *first = coupling->first_partner + island->places[i];
        const bool was_boundary = island->is_boundary[i];
        island->is_boundary[i] = false;
        for (size_t n = first[0]; n < first[1]; n++) {
            const bool is_outside = connect_partner(islands, island, i, coupling->partners[n]);
            island->is_boundary[i] = island->is_boundary[i] || is_outside;
        }
        if (island->is_run && island->is_boundary[i] && !was_boundary) {
            encounter_track_write(&islands->tracks[island->places[i]], &island->encounter, i);
        }
    }
    for (size_t i = 0; island->is_run && i < input->source_count; i++) {
        for (size_t k = 0; k < before.source_count; k++) {
            if (before.sources[k] == input->sources[i]) {
                input->versions[i] = before.versions[k];
            }
        }
    }
    free(before.sources);
    free(before.versions);
    island->encounter.input = input;
}

void encounter_blocks_connect(EncounterIslands *islands)
{
    for (size_t i = 0; i < islands->count; i++) {
        EncounterIsland *island = islands->islands[i];
        island->encounter.input = NULL;
        if (islands->is_divided[island->places[0]]) {
            connect_block(islands, island);
        }
    }
}

void encounter_blocks_begin(EncounterIslands *islands)
{
    for (size_t i = 0; i < islands->all->joint_count; i++) {
        encounter_track_clear(&islands->tracks[i]);
        islands->is_kept_whole[i] = islands->is_to_divide[i] = false;
        islands->waits[i] -= islands->waits[i] > 0 ? 1 : 0;
    }
}

// Whether a block has to be run: for the first time, or under what others do now.
static bool is_due(const EncounterIsland *island)
{
    return !island->is_run || (island->encounter.input != NULL &&
                               encounter_input_has_changed(island->encounter.input));
}

// Runs a block from the start of the step with the lengths of local steps that it began with.
static bool run_block(EncounterIslands *islands, EncounterIsland *island, EncounterRunIsland *run,
                      double duration)
{
    Encounter *encounter = &island->encounter;
    if (island->is_run) {
        memcpy(encounter->longest_s, island->longest_s, sizeof encounter->longest_s);
        encounter->stiff_width_s = island->stiff_width_s;
    } else {
        memcpy(island->longest_s, encounter->longest_s, sizeof encounter->longest_s);
        island->stiff_width_s = encounter->stiff_width_s;
    }
    encounter->event_most = SIZE_MAX;
    encounter_input_take(encounter->input);
    if (!run(islands, island, duration)) {
        return false;
    }
    for (size_t i = 0; i < encounter->joint_count; i++) {
        if (island->is_boundary[i]) {
            encounter_track_write(&islands->tracks[island->places[i]], encounter, i);
        }
    }
    return true;
}

// Runs an island that is not divided. One that has too many events is to be, in this step and in
// more after it than the last time.
static EncounterBlocksEnd run_whole(EncounterIslands *islands, EncounterIsland *island,
                                    EncounterRunIsland *run, double duration)
{
    Encounter *encounter = &island->encounter;
    const size_t *places = island->places;
    const bool may_be_divided =
        encounter->joint_count > islands->undivided_most && !islands->is_kept_whole[places[0]];
    encounter->event_most = may_be_divided ? islands->events_most : SIZE_MAX;
    if (run(islands, island, duration)) {
        for (size_t i = 0; i < encounter->joint_count; i++) {
            islands->patience[places[i]] = 0;
        }
        return ENCOUNTER_BLOCKS_DONE;
    }
    if (encounter->event_count <= encounter->event_most) {
        return ENCOUNTER_BLOCKS_FAILED;
    }
    const unsigned patience = 2 * islands->patience[places[0]] + PATIENCE_LEAST;
    for (size_t i = 0; i < encounter->joint_count; i++) {
        islands->patience[places[i]] = patience < PATIENCE_MOST ? patience : PATIENCE_MOST;
        islands->waits[places[i]] = islands->patience[places[i]];
        islands->is_to_divide[places[i]] = true;
    }
    return ENCOUNTER_BLOCKS_ANEW;
}

// Keeps the islands whole whose blocks do not agree.
static EncounterBlocksEnd give_up(EncounterIslands *islands)
{
    for (size_t i = 0; i < islands->count; i++) {
        const EncounterIsland *island = islands->islands[i];
        if (is_due(island)) {
            const size_t parent = islands->parents[island->places[0]];
            for (size_t k = 0; k < islands->all->joint_count; k++) {
                islands->is_kept_whole[k] =
                    islands->is_kept_whole[k] || islands->parents[k] == parent;
            }
        }
    }
    return ENCOUNTER_BLOCKS_ANEW;
}

EncounterBlocksEnd encounter_blocks_run(EncounterIslands *islands, EncounterRunIsland *run,
                                        double duration)
{
    EncounterBlocksEnd end = ENCOUNTER_BLOCKS_DONE;
    for (size_t round = 0; round < ROUNDS_MOST; round++) {
        bool is_any = false;
        for (size_t i = 0; i < islands->count; i++) {
            EncounterIsland *island = islands->islands[i];
            if (!is_due(island)) {
                continue;
            }
            if (island->encounter.input == NULL) {
                const EncounterBlocksEnd whole = run_whole(islands, island, run, duration);
                if (whole == ENCOUNTER_BLOCKS_FAILED) {
                    return whole;
                }
                end = whole == ENCOUNTER_BLOCKS_ANEW ? whole : end;
            } else if (!run_block(islands, island, run, duration)) {
                return ENCOUNTER_BLOCKS_FAILED;
            } else {
                is_any = true;
            }
        }
        if (!is_any || end == ENCOUNTER_BLOCKS_ANEW) {
            return end;
        }
    }
    return give_up(islands);
}

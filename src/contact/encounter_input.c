// What do places outside an encounter add to the free motion of its rows?
//
// With P, Q and f the impulses, their integrals and the forces of those places, and W their
// mobilities:  W Q to the positions, W P to the speeds, W f to the accelerations.
#include "contact/encounter_input.h"

#include "base/room.h"
#include "base/zeroed.h"

#include <math.h>

// Forgets what the tracks add.
static void input_forget(EncounterInput *input)
{
    for (size_t i = 0; i < ENCOUNTER_ADDED; i++) {
        input->added[i].time_s = NAN;
    }
    input->last = input->added;
}

EncounterInput *encounter_input_create(size_t rows)
{
    EncounterInput *input = zeroed(1, sizeof *input);
    for (size_t i = 0; i < ENCOUNTER_ADDED; i++) {
        EncounterAdded *added = &input->added[i];
        added->position = zeroed(3 * rows, sizeof *added->position);
        added->speed = added->position + rows;
        added->acceleration = added->speed + rows;
    }
    input_forget(input);
    return input;
}

void encounter_input_destroy(EncounterInput *input)
{
    if (input != NULL) {
        free(input->sources);
        free(input->versions);
        free(input->links);
        free(input->nodes);
        for (size_t i = 0; i < ENCOUNTER_ADDED; i++) {
            free(input->added[i].position);
        }
        free(input);
    }
}

void encounter_input_clear(EncounterInput *input)
{
    input->source_count = input->link_count = 0;
    input_forget(input);
}

size_t encounter_input_add(EncounterInput *input, const EncounterTrack *track)
{
    const size_t number = input->source_count++;
    input->sources =
        room_grow(input->sources, &input->source_room, input->source_count, sizeof *input->sources);
    input->versions = room_grow(input->versions, &input->version_room, input->source_count,
                                sizeof *input->versions);
    input->nodes =
        room_grow(input->nodes, &input->node_room, input->source_count, sizeof *input->nodes);
    input->sources[number] = track;
    input->versions[number] = 0;
    return number;
}

void encounter_input_link(EncounterInput *input, const EncounterLink *link)
{
    input->links =
        room_grow(input->links, &input->link_room, input->link_count + 1, sizeof *input->links);
    input->links[input->link_count++] = *link;
}

bool encounter_input_has_changed(const EncounterInput *input)
{
    for (size_t i = 0; i < input->source_count; i++) {
        if (input->versions[i] != input->sources[i]->version) {
            return true;
        }
    }
    return false;
}

void encounter_input_take(EncounterInput *input)
{
    for (size_t i = 0; i < input->source_count; i++) {
        input->versions[i] = input->sources[i]->version;
        input->nodes[i] = 0;
    }
    input_forget(input);
}

// Adds what all tracks do at a time.
static void add_tracks(EncounterInput *input, double time_s, EncounterAdded *added)
{
    double impulse[ENCOUNTER_ROWS_MOST];
    double moment[ENCOUNTER_ROWS_MOST];
    double force[ENCOUNTER_ROWS_MOST];
    size_t known = SIZE_MAX;
    for (size_t n = 0; n < input->link_count; n++) {
        const EncounterLink *link = &input->links[n];
        const EncounterTrack *track = input->sources[link->source];
        if (track->count == 0) {
            continue;
        }
        if (known != link->source) {
            encounter_track_at(track, time_s, input->is_before, &input->nodes[link->source],
                               impulse, moment, force);
            known = link->source;
        }
        for (size_t i = 0; i < link->rows; i++) {
            for (size_t k = 0; k < track->rows; k++) {
                const double mobility = link->is_transposed ? link->mobility[k * link->rows + i]
                                                            : link->mobility[i * track->rows + k];
                added->position[link->row + i] += mobility * moment[k];
                added->speed[link->row + i] += mobility * impulse[k];
                added->acceleration[link->row + i] += mobility * force[k];
            }
        }
    }
}

const EncounterAdded *encounter_input_find(EncounterInput *input, size_t row_count, double time_s)
{
    for (size_t i = 0; i < ENCOUNTER_ADDED; i++) {
        EncounterAdded *added = &input->added[i];
        if (added->time_s == time_s && added->is_before == input->is_before) {
            return input->last = added;
        }
    }
    EncounterAdded *added = &input->added[input->oldest];
    input->oldest = (input->oldest + 1) % ENCOUNTER_ADDED;
    memset(added->position, 0, 3 * row_count * sizeof *added->position);
    add_tracks(input, time_s, added);
    added->time_s = time_s;
    added->is_before = input->is_before;
    return input->last = added;
}

void encounter_input_look(const Encounter *encounter, bool is_before)
{
    if (encounter->input != NULL) {
        encounter->input->is_before = is_before;
    }
}

double encounter_input_stop(const Encounter *encounter, double after_s)
{
    double first_s = INFINITY;
    for (size_t i = 0; encounter->input != NULL && i < encounter->input->source_count; i++) {
        first_s = fmin(first_s, encounter_track_stop(encounter->input->sources[i], after_s));
    }
    return first_s;
}

double encounter_input_node(const Encounter *encounter, double after_s)
{
    double first_s = INFINITY;
    for (size_t i = 0; encounter->input != NULL && i < encounter->input->source_count; i++) {
        first_s = fmin(first_s, encounter_track_node(encounter->input->sources[i], after_s));
    }
    return first_s;
}

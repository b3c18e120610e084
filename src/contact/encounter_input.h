// What places outside an encounter do to its rows in a step: tracks of theirs, and the mobilities
// by which these move the rows.
#pragma once

#include "contact/encounter_track.h"

// From one track to the rows of one joint.
typedef struct EncounterLink {
    size_t source; // which track
    size_t row;    // the joint's first, and how many
    size_t rows;
    const double *mobility; // 1/kg
    bool is_transposed;     // row by row of the track's rows, not of the joint's
} EncounterLink;

// What all tracks add to the free motion at a time, by row.
typedef struct EncounterAdded {
    double time_s;        // NAN: of none
    bool is_before;       // whether forces that jump then are those before it
    double *position;     // m; owned, with the next two
    double *speed;        // m/s
    double *acceleration; // m/s^2
} EncounterAdded;

enum { ENCOUNTER_ADDED = 4 }; // times that a local step comes back to

typedef struct EncounterInput {
    size_t source_count;
    size_t source_room;
    const EncounterTrack **sources; // the tracks; owned, as are all arrays
    size_t version_room;
    size_t *versions; // of the tracks at which the encounter was run
    size_t node_room;
    size_t *nodes; // by track: where it was looked at last
    size_t link_count;
    size_t link_room;
    EncounterLink *links; // of a track one after the other
    bool is_before;       // whether forces that jump are wanted as they are before
    EncounterAdded added[ENCOUNTER_ADDED];
    size_t oldest;        // of them
    EncounterAdded *last; // the one that was asked for last
} EncounterInput;

// An input of no tracks, for so many rows.
EncounterInput *encounter_input_create(size_t rows);
void encounter_input_destroy(EncounterInput *input);

// Takes all tracks out.
void encounter_input_clear(EncounterInput *input);

// Adds a track, which is kept as a pointer; returns its number.
size_t encounter_input_add(EncounterInput *input, const EncounterTrack *track);

// Adds what moves the rows of a joint.
void encounter_input_link(EncounterInput *input, const EncounterLink *link);

// Whether any of the tracks has changed since the encounter was run; and that it is run now.
bool encounter_input_has_changed(const EncounterInput *input);
void encounter_input_take(EncounterInput *input);

// Finds what the tracks add at a time among what is known, or works it out.
const EncounterAdded *encounter_input_find(EncounterInput *input, size_t row_count, double time_s);

// What they add at a time.
static inline const EncounterAdded *encounter_input_at(const Encounter *encounter, double time_s)
{
    EncounterInput *input = encounter->input;
    const EncounterAdded *last = input->last;
    return last->time_s == time_s && last->is_before == input->is_before
               ? last
               : encounter_input_find(input, encounter->row_count, time_s);
}

// Takes forces that jump at a time as they are before it, or behind it.
void encounter_input_look(const Encounter *encounter, bool is_before);

// The next time, s, at which the contact of a track begins or ends, or any has a node; INFINITY
// where there is none, or no track.
double encounter_input_stop(const Encounter *encounter, double after_s);
double encounter_input_node(const Encounter *encounter, double after_s);

// What one place of an encounter did in a step, for encounters whose places it moves: its impulses,
// their integrals and its forces over time, between the nodes as contact/encounter_nodes.c has it.
#pragma once

#include "contact/encounter.h"

typedef struct EncounterTrack {
    size_t rows;
    size_t count; // of nodes; 0: nothing acts
    size_t room;
    double *times;  // s, since the start of the step; owned, as the other arrays
    double *values; // by node: impulse, its integral over time, force; each by row
    size_t value_room;
    size_t stop_count;
    size_t stop_room;
    double *stops;  // s: when the contact begins or ends
    size_t version; // how often it has changed in this step by more than is allowed; 0: never
} EncounterTrack;

void encounter_track_finish(EncounterTrack *track);

// Takes all from a track that it did in the step before.
void encounter_track_clear(EncounterTrack *track);

// Writes the track of one joint of an encounter that has been run through a step, and counts a new
// version where an impulse has changed by more than the joint's tolerance, relative to the largest
// one and to that of its impact.
void encounter_track_write(EncounterTrack *track, const Encounter *encounter, size_t joint);

// What acts in each row at a time, by row: impulse, its integral over time, and force. At a time of
// several nodes it is that of the last of them, or of the first where it is asked for. `node` is
// the one to begin looking at, and then the one that was found.
void encounter_track_at(const EncounterTrack *track, double time_s, bool is_before, size_t *node,
                        double *impulse, double *moment, double *force);

// The first time after another, s, at which the contact begins or ends, or of which there is a
// node; INFINITY where there is none.
double encounter_track_stop(const EncounterTrack *track, double after_s);
double encounter_track_node(const EncounterTrack *track, double after_s);

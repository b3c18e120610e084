// What does a place do over a step, as others feel it?
//
// The track is the encounter's own nodes, of the rows of one joint. It has changed where its
// impulse at any node is further from that of the track before than the error that the local steps
// allow, relative to the largest impulse m v of the step: with v the speed at which the contact
// began and m the mass that gives the frequency of the contact's oscillation.
#include "contact/encounter_track.h"

#include "base/room.h"
#include "contact/encounter_quintic.h"

#include <math.h>

void encounter_track_finish(EncounterTrack *track)
{
    free(track->times);
    free(track->values);
    free(track->stops);
    *track = (EncounterTrack){.count = 0};
}

void encounter_track_clear(EncounterTrack *track)
{
    track->count = track->stop_count = track->version = 0;
}

// The first of the times behind one, or the last before it, by its number; `count` where none is.
static size_t track_find(const double *times, size_t count, double time_s, bool is_before)
{
    size_t low = 0;
    size_t high = count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (is_before ? times[middle] < time_s : times[middle] <= time_s) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

// Whether a time lies behind a node and before the next one.
static bool track_is_behind(const EncounterTrack *track, size_t node, double time_s, bool is_before)
{
    const double *times = track->times + node;
    if (node + 1 >= track->count) {
        return false;
    }
    return is_before ? times[0] < time_s && time_s <= times[1]
                     : times[0] <= time_s && time_s < times[1];
}

void encounter_track_at(const EncounterTrack *track, double time_s, bool is_before, size_t *begin,
                        double *impulse, double *moment, double *force)
{
    const size_t rows = track->rows;
    if (!track_is_behind(track, *begin, time_s, is_before)) {
        const size_t behind = track_find(track->times, track->count, time_s, is_before);
        *begin = behind > 0 ? behind - 1 : 0;
    }
    const size_t node = *begin;
    const size_t next = node + 1 < track->count ? node + 1 : node;
    const double *first = track->values + 3 * rows * node;
    const double *last = track->values + 3 * rows * next;
    const double width = track->times[next] - track->times[node];
    const double s = width > 0.0 ? (time_s - track->times[node]) / width : 0.0;
    const bool is_short = width < ENCOUNTER_NARROW * track->times[track->count - 1];
    for (size_t i = 0; i < rows; i++) {
        const EncounterNodeRow at = encounter_quintic(
            (EncounterNodeRow){first[i], first[rows + i], first[2 * rows + i], 0.0},
            (EncounterNodeRow){last[i], last[rows + i], last[2 * rows + i], 0.0}, width, s,
            is_short);
        impulse[i] = at.impulse;
        moment[i] = at.moment;
        force[i] = at.force;
    }
}

double encounter_track_stop(const EncounterTrack *track, double after_s)
{
    const size_t at = track_find(track->stops, track->stop_count, after_s, false);
    return at < track->stop_count ? track->stops[at] : INFINITY;
}

double encounter_track_node(const EncounterTrack *track, double after_s)
{
    const size_t at = track_find(track->times, track->count, after_s, false);
    return at < track->count ? track->times[at] : INFINITY;
}

// The largest change of an impulse from the track to what the encounter has now, and the largest
// impulse of both, N s.
static double track_change(const EncounterTrack *track, const Encounter *encounter, size_t joint,
                           double *largest)
{
    const EncounterJoint *of = &encounter->joints[joint];
    double impulse[ENCOUNTER_ROWS_MOST] = {0.0};
    double moment[ENCOUNTER_ROWS_MOST];
    double force[ENCOUNTER_ROWS_MOST];
    double change = 0.0;
    size_t begin = 0;
    *largest = 0.0;
    for (size_t node = 0; node < encounter->node_count; node++) {
        const double *now = encounter_node_values(encounter, node) + of->first_row;
        if (track->count > 0) {
            encounter_track_at(track, encounter->times[node], false, &begin, impulse, moment,
                               force);
        }
        *largest = fmax(*largest, fmax(hypot(now[0], now[1]), hypot(impulse[0], impulse[1])));
        double apart = hypot(now[0] - impulse[0], now[1] - impulse[1]);
        if (of->row_count > ENCOUNTER_ROW_AXIAL) {
            // friction of a pin along its axis, which is in neither of the two
            apart = hypot(apart, now[ENCOUNTER_ROW_AXIAL] - impulse[ENCOUNTER_ROW_AXIAL]);
        }
        change = apart <= change ? change : apart; // a NaN must show
    }
    return change;
}

void encounter_track_write(EncounterTrack *track, const Encounter *encounter, size_t joint)
{
    const EncounterJoint *of = &encounter->joints[joint];
    const size_t rows = encounter->row_count;
    const size_t count = encounter->node_count;
    double largest;
    const double change = track_change(track, encounter, joint, &largest);
    const double met = of->frequency > 0.0 && of->impact_speed > 0.0
                           ? of->force_per_speed * of->impact_speed / of->frequency
                           : 0.0;
    if (change > 0.0 && !(change <= of->tolerance * fmax(largest, met))) {
        track->version++;
    }
    track->rows = of->row_count;
    track->times = room_grow(track->times, &track->room, count, sizeof *track->times);
    track->values = room_grow(track->values, &track->value_room, 3 * track->rows * count,
                              sizeof *track->values);
    track->stops = room_grow(track->stops, &track->stop_room, count, sizeof *track->stops);
    track->count = count;
    track->stop_count = 0;
    for (size_t node = 0; node < count; node++) {
        track->times[node] = encounter->times[node];
        const double *values = encounter_node_values(encounter, node);
        const double *parts[3] = {values, values + rows, encounter_node_forces(encounter, node)};
        for (size_t part = 0; part < 3; part++) {
            memcpy(track->values + (3 * node + part) * track->rows, parts[part] + of->first_row,
                   track->rows * sizeof *track->values);
        }
        if (node > 0 && encounter_touches(encounter, node, joint) !=
                            encounter_touches(encounter, node - 1, joint)) {
            track->stops[track->stop_count++] = track->times[node];
        }
    }
}

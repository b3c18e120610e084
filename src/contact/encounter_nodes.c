// How is what happened in an encounter kept, and looked up between the nodes?
//
// Between two nodes the integral Q of the impulse is Hermite's quintic through Q, P = Q' and f =
// Q'' at both; its derivatives are impulse and force, right to the orders 4 and 3 of the local
// step. Where two contacts that should end together do so a rounding apart, the force is linear
// between the nodes: a difference of integrals over the square of that time would be rounding.
#include "contact/encounter_force.h"

#include "base/memory.h"
#include "contact/encounter_quintic.h"
#include "contact/encounter_stiff.h"

#include <stdlib.h>
#include <string.h>

enum {
    FIRST_ROOM = 8, // nodes; a step without contacts has two
    // what more a step took is given back when steps are calm again: of many mechanisms side by
    // side few touch at a time
    MOST_KEPT = 32,
};

// Marks which joints touch from a node on, and how fast they close.
static void set_touching(const Encounter *encounter, const EncounterPoint *point, uint64_t *words,
                         double *closings)
{
    const size_t count = encounter->joint_count;
    for (size_t first = 0; first < count; first += 64) {
        uint64_t bits = 0;
        for (size_t i = first; i < count && i < first + 64; i++) {
            const bool touches = encounter->joints[i].is_touching;
            bits |= touches ? UINT64_C(1) << (i - first) : 0;
            closings[i] = touches ? encounter_point_pose(encounter, point, i)->approach_speed : 0.0;
        }
        words[first / 64] = bits;
    }
}

bool encounter_touches_any(const Encounter *encounter, size_t node)
{
    const size_t words = (encounter->joint_count + 63) / 64;
    for (size_t i = 0; i < words; i++) {
        if (encounter->touching[node * words + i] != 0) {
            return true;
        }
    }
    return false;
}

// Gives back the room for nodes.
static void drop_nodes(Encounter *encounter)
{
    free(encounter->times);
    free(encounter->values);
    free(encounter->closings);
    free(encounter->losses);
    free(encounter->touching);
    encounter->times = encounter->values = encounter->closings = encounter->losses = NULL;
    encounter->touching = NULL;
    encounter->node_room = 0;
}

void encounter_nodes_begin(Encounter *encounter)
{
    if (encounter->node_room > MOST_KEPT && encounter->node_room > 4 * encounter->node_count) {
        drop_nodes(encounter);
    }
    encounter->node_count = 0;
}

// Makes room for more nodes.
static void grow_nodes(Encounter *encounter)
{
    const size_t room = 2 * encounter->node_room + FIRST_ROOM;
    const size_t rows = encounter->row_count;
    const size_t joints = encounter->joint_count;
    const size_t words = (joints + 63) / 64;
    encounter->times = memory_grown(encounter->times, room, sizeof *encounter->times);
    encounter->values =
        memory_grown(encounter->values, 4 * rows * room + 1, sizeof *encounter->values);
    encounter->closings =
        memory_grown(encounter->closings, joints * room + 1, sizeof *encounter->closings);
    encounter->losses = memory_grown(encounter->losses, 2 * room, sizeof *encounter->losses);
    encounter->touching =
        memory_grown(encounter->touching, words * room + 1, sizeof *encounter->touching);
    encounter->node_room = room;
}

void encounter_nodes_add(Encounter *encounter, const EncounterPoint *point)
{
    if (encounter->node_count == encounter->node_room) {
        grow_nodes(encounter);
    }
    const size_t rows = encounter->row_count;
    const size_t joints = encounter->joint_count;
    const size_t words = (joints + 63) / 64;
    const size_t node = encounter->node_count++;
    double *values = encounter->values + 4 * rows * node;
    encounter->times[node] = point->time_s;
    // as they stand in the point: impulses, both integrals, forces
    for (size_t i = 0; i < 4 * rows; i++) {
        values[i] = point->impulse[i];
    }
    memcpy(encounter->losses + 2 * node, point->losses, sizeof point->losses);
    set_touching(encounter, point, encounter->touching + words * node,
                 encounter->closings + joints * node);
}

void encounter_nodes_settle(Encounter *encounter)
{
    encounter_stiff_settled(encounter, encounter->values + 3 * encounter->row_count);
}

size_t encounter_node(const Encounter *encounter, double time_s)
{
    size_t low = 0;
    size_t high = encounter->node_count;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (encounter->times[middle] <= time_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static EncounterNodeRow node_row(const double *values, size_t rows, size_t row)
{
    return (EncounterNodeRow){.impulse = values[row],
                              .moment = values[rows + row],
                              .second = values[2 * rows + row],
                              .force = values[3 * rows + row]};
}

void encounter_at(const Encounter *encounter, size_t node, double time_s, EncounterSums *sums)
{
    const size_t rows = encounter_rows(encounter);
    const size_t next = node + 1 < encounter->node_count ? node + 1 : node;
    const double *first = encounter_node_values(encounter, node);
    const double *last = encounter_node_values(encounter, next);
    const double width = encounter->times[next] - encounter->times[node];
    const double s = width > 0.0 ? (time_s - encounter->times[node]) / width : 0.0;
    const bool is_short = width < ENCOUNTER_NARROW * encounter->times[encounter->node_count - 1];
    for (size_t i = 0; i < rows; i++) {
        const EncounterNodeRow at = encounter_quintic(node_row(first, rows, i),
                                                      node_row(last, rows, i), width, s, is_short);
        sums->impulse[i] = at.impulse;
        sums->moment[i] = at.moment;
        sums->moment[rows + i] = at.second;
        sums->force[i] = at.force;
    }
    const double *before = encounter->losses + 2 * node;
    const double *after = encounter->losses + 2 * next;
    sums->dissipated = before[0] + s * (after[0] - before[0]);
    sums->friction = before[1] + s * (after[1] - before[1]);
}

EncounterPose encounter_pose(const Encounter *encounter, size_t joint, size_t node, double time_s,
                             const EncounterSums *sums)
{
    const size_t row = encounter->joints[joint].first_row;
    return (EncounterPose){
        .pose = encounter_motion_pose(encounter, joint, time_s, sums->impulse, sums->moment),
        .force = {sums->force[row], sums->force[row + 1]},
        .is_touching = encounter_touches(encounter, node, joint),
    };
}

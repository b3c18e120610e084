// Which contacts have to be integrated together in a step, and what comes of all of them?
//
// A place may touch in a step if its gap is no longer than
//     h (|u'| + sum |W| V) + h^2 |g| / 2
// with V how much the impulses of its partners vary in the step, and W their mobilities. First V is
// taken to be zero; once the islands are run it is known. Places that may touch now are active as
// well, and islands that have grown by them are run again, from the start of the step.
#include "contact/encounter_islands.h"

#include "contact/encounter_blocks.h"

#include "base/leaders.h"
#include "base/zeroed.h"
#include "contact/encounter_force.h"

#include <math.h>
#include <string.h>

EncounterIslands *encounter_islands_create(Encounter *all, const EncounterCoupling *coupling)
{
    const size_t count = all->joint_count;
    EncounterIslands *islands = zeroed(1, sizeof *islands);
    islands->all = all;
    islands->coupling = *coupling;
    islands->islands = zeroed(count, sizeof *islands->islands);
    islands->kept = zeroed(count, sizeof *islands->kept);
    islands->island_of = zeroed(count, sizeof *islands->island_of);
    islands->number_in = zeroed(count, sizeof *islands->number_in);
    islands->is_active = zeroed(count, sizeof *islands->is_active);
    islands->pushes = zeroed(count, sizeof *islands->pushes);
    islands->leaders = zeroed(count, sizeof *islands->leaders);
    islands->longest_s = zeroed(count, sizeof *islands->longest_s);
    islands->undivided_most = ENCOUNTER_LARGE;
    islands->events_most = ENCOUNTER_BUSY;
    islands->clusters = encounter_blocks_cluster(all, coupling);
    islands->parents = zeroed(count, sizeof *islands->parents);
    islands->is_divided = zeroed(count, sizeof *islands->is_divided);
    islands->is_to_divide = zeroed(count, sizeof *islands->is_to_divide);
    islands->waits = zeroed(count, sizeof *islands->waits);
    islands->patience = zeroed(count, sizeof *islands->patience);
    islands->is_kept_whole = zeroed(count, sizeof *islands->is_kept_whole);
    islands->tracks = zeroed(count, sizeof *islands->tracks);
    for (size_t i = 0; i < count; i++) {
        islands->longest_s[i][0] = islands->longest_s[i][1] = INFINITY;
    }
    return islands;
}

void encounter_islands_destroy(EncounterIslands *islands)
{
    if (islands == NULL) {
        return;
    }
    for (size_t i = 0; i < islands->all->joint_count; i++) {
        encounter_island_free(islands->kept[i]);
        encounter_track_finish(&islands->tracks[i]);
    }
    free(islands->clusters);
    free(islands->parents);
    free(islands->is_divided);
    free(islands->is_to_divide);
    free(islands->is_kept_whole);
    free(islands->waits);
    free(islands->patience);
    free(islands->tracks);
    free(islands->islands);
    free(islands->kept);
    free(islands->island_of);
    free(islands->number_in);
    free(islands->is_active);
    free(islands->pushes);
    free(islands->leaders);
    free(islands->longest_s);
    free(islands);
}

// Whether a place that does not touch may do so in a step of a length while others push it, m/s.
static bool may_touch(const Encounter *all, const EncounterJoint *joint, double duration,
                      double push)
{
    const size_t row = joint->first_row;
    const double *position = all->position + row;
    const double *speed = all->speed + row;
    const double *free = all->free + row;
    const double half_s = 0.5 * duration;
    if (joint->shape != TOUCH_HOLE && joint->shape != TOUCH_DISC) {
        return position[0] <= duration * (push + fabs(speed[0]) + half_s * fabs(free[0]));
    }
    const double size = hypot(position[0], position[1]);
    const double gap = joint->shape == TOUCH_HOLE ? joint->radial_clearance - size
                                                  : joint->radial_clearance + size;
    const double fastest = push + hypot(speed[0], speed[1]) + half_s * hypot(free[0], free[1]);
    return gap <= duration * fastest;
}

// Finds which places belong together: the leader of each is the first of them.
static void join_partners(EncounterIslands *islands)
{
    const EncounterCoupling *coupling = &islands->coupling;
    const size_t count = islands->all->joint_count;
    leaders_start(islands->leaders, count);
    for (size_t i = 0; i < count; i++) {
        for (size_t n = coupling->first_partner[i];
             islands->is_active[i] && n < coupling->first_partner[i + 1]; n++) {
            const size_t partner = coupling->partners[n];
            if (islands->is_active[partner]) {
                leaders_join(islands->leaders, i, partner);
            }
        }
    }
}

// Sorts the active places into islands: their numbers, and those of each island's places.
static size_t *number_active(EncounterIslands *islands)
{
    const size_t count = islands->all->joint_count;
    size_t *sizes = zeroed(count, sizeof *sizes);
    islands->count = 0;
    for (size_t i = 0; i < count; i++) {
        islands->island_of[i] = count;
        if (islands->is_active[i]) {
            const size_t leader = leaders_find(islands->leaders, i);
            const size_t number = leader == i ? islands->count++ : islands->island_of[leader];
            islands->island_of[i] = number;
            islands->number_in[i] = sizes[number]++;
        }
    }
    return sizes;
}

// Whether an island consists of those places.
static bool is_same(const EncounterIsland *island, const size_t *places, size_t count)
{
    return island != NULL && island->encounter.joint_count == count &&
           memcmp(island->places, places, count * sizeof *places) == 0;
}

// The places of a joint are active together: what it does is the sum of what they do, and how stiff
// one is depends on the others.
static void activate_joints(EncounterIslands *islands)
{
    const EncounterJoint *joints = islands->all->joints;
    const size_t count = islands->all->joint_count;
    for (size_t first = 0, end; first < count; first = end) {
        bool is_any = false;
        for (end = first; end < count && joints[end].joint == joints[first].joint; end++) {
            is_any = is_any || islands->is_active[end];
        }
        for (size_t i = first; i < end; i++) {
            islands->is_active[i] = is_any;
        }
    }
}

// Makes the islands of the places that are active now; those that are as they were stay.
static void make_islands(EncounterIslands *islands)
{
    const size_t count = islands->all->joint_count;
    activate_joints(islands);
    join_partners(islands);
    encounter_blocks_divide(islands);
    size_t *sizes = number_active(islands);
    size_t **places = zeroed(islands->count, sizeof *places);
    for (size_t i = 0; i < islands->count; i++) {
        places[i] = zeroed(sizes[i], sizeof *places[i]);
    }
    for (size_t i = 0; i < count; i++) {
        if (islands->is_active[i]) {
            places[islands->island_of[i]][islands->number_in[i]] = i;
        }
    }
    for (size_t i = 0; i < islands->count; i++) {
        EncounterIsland **kept = &islands->kept[places[i][0]];
        if (is_same(*kept, places[i], sizes[i])) {
            free(places[i]);
        } else {
            encounter_island_free(*kept);
            *kept = encounter_island_make(islands, places[i], sizes[i]);
        }
        islands->islands[i] = *kept;
    }
    free(places);
    free(sizes);
    encounter_blocks_connect(islands);
}

// How much the impulses in an island's rows vary in the step.
static void find_variations(const Encounter *encounter, double *variations)
{
    const size_t rows = encounter->row_count;
    memset(variations, 0, rows * sizeof *variations);
    for (size_t node = 0; node + 1 < encounter->node_count; node++) {
        const double *impulse = encounter_node_values(encounter, node);
        for (size_t row = 0; row < rows; row++) {
            variations[row] += fabs(impulse[4 * rows + row] - impulse[row]);
        }
    }
}

// Adds what an island does to places that fly.
static void add_pushes(EncounterIslands *islands, const EncounterIsland *island)
{
    const EncounterCoupling *coupling = &islands->coupling;
    const Encounter *encounter = &island->encounter;
    double *variations = encounter->work->speeds;
    find_variations(encounter, variations);
    for (size_t i = 0; i < encounter->joint_count; i++) {
        const size_t place = island->places[i];
        for (size_t n = coupling->first_partner[place]; n < coupling->first_partner[place + 1];
             n++) {
            const size_t other = coupling->partners[n];
            if (!islands->is_active[other]) {
                islands->pushes[other] +=
                    encounter_coupling_push(coupling, islands->all, place,
                                            variations + encounter->joints[i].first_row, other);
            }
        }
    }
}

// Makes the places active that may touch after all. Returns whether there are any.
static bool activate(EncounterIslands *islands, double duration)
{
    const Encounter *all = islands->all;
    bool is_any = false;
    for (size_t i = 0; i < islands->count; i++) {
        add_pushes(islands, islands->islands[i]);
    }
    for (size_t i = 0; i < all->joint_count; i++) {
        if (islands->pushes[i] > 0.0 &&
            may_touch(all, &all->joints[i], duration, islands->pushes[i])) {
            islands->is_active[i] = is_any = true;
        }
        islands->pushes[i] = 0.0;
    }
    return is_any;
}

// Hands what lives on from step to step back to all places. Islands of other steps are of no use.
static void keep_states(EncounterIslands *islands, double duration)
{
    Encounter *all = islands->all;
    for (size_t i = 0; i < all->joint_count; i++) {
        EncounterJoint *joint = &all->joints[i];
        if (islands->kept[i] != NULL && !islands->kept[i]->is_run) {
            encounter_island_free(islands->kept[i]);
            islands->kept[i] = NULL;
        }
        if (!islands->is_active[i]) {
            const double *own = islands->coupling.block(islands->coupling.context, i, i);
            joint->mobility_before[0] = own[0];
            joint->mobility_before[1] = own[1];
            joint->mobility_before[2] = own[joint->row_count + 1];
            continue;
        }
        const Encounter *encounter = &islands->islands[islands->island_of[i]]->encounter;
        const size_t first = joint->first_row;
        *joint = encounter->joints[islands->number_in[i]];
        joint->first_row = first;
        memcpy(islands->longest_s[i], encounter->longest_s, sizeof encounter->longest_s);
    }
    islands->duration_before_s = duration;
}

static bool run_island(EncounterIslands *islands, EncounterIsland *island, double duration)
{
    const size_t before = island->encounter.evaluations;
    encounter_island_start(islands, island);
    if (!encounter_run(&island->encounter, duration)) {
        return false;
    }
    island->is_run = true;
    islands->all->evaluations += island->encounter.evaluations - before;
    return true;
}

bool encounter_islands_run(EncounterIslands *islands, double duration)
{
    Encounter *all = islands->all;
    for (size_t i = 0; i < all->joint_count; i++) {
        islands->is_active[i] =
            all->joints[i].is_touching || may_touch(all, &all->joints[i], duration, 0.0);
        if (islands->kept[i] != NULL) {
            islands->kept[i]->is_run = false;
        }
    }
    encounter_blocks_begin(islands);
    EncounterBlocksEnd end;
    do {
        make_islands(islands);
        end = encounter_blocks_run(islands, run_island, duration);
        if (end == ENCOUNTER_BLOCKS_FAILED) {
            return false;
        }
    } while (end == ENCOUNTER_BLOCKS_ANEW || activate(islands, duration));
    keep_states(islands, duration);
    return true;
}

void encounter_island_look(EncounterIsland *island, size_t node, double time_s)
{
    island->node = node;
    island->look_s = time_s;
    encounter_at(&island->encounter, node, time_s, &island->sums);
}

void encounter_islands_look(EncounterIslands *islands, double time_s, EncounterSums *sums)
{
    const Encounter *all = islands->all;
    memset(sums->impulse, 0, all->row_count * sizeof *sums->impulse);
    memset(sums->moment, 0, all->row_count * sizeof *sums->moment);
    memset(sums->force, 0, all->row_count * sizeof *sums->force);
    sums->dissipated = sums->friction = 0.0;
    for (size_t i = 0; i < islands->count; i++) {
        EncounterIsland *island = islands->islands[i];
        const Encounter *encounter = &island->encounter;
        encounter_island_look(island, encounter_node(encounter, time_s), time_s);
        for (size_t k = 0; k < encounter->joint_count; k++) {
            const EncounterJoint *joint = &encounter->joints[k];
            const size_t row = all->joints[island->places[k]].first_row;
            const size_t size = joint->row_count * sizeof(double);
            memcpy(sums->impulse + row, island->sums.impulse + joint->first_row, size);
            memcpy(sums->moment + row, island->sums.moment + joint->first_row, size);
            memcpy(sums->force + row, island->sums.force + joint->first_row, size);
        }
        sums->dissipated += island->sums.dissipated;
        sums->friction += island->sums.friction;
    }
}

// How a place that flies is pushed by the impulses of others, of which the sums are given.
static PinHole flying_pose(const EncounterIslands *islands, size_t place, double time_s,
                           const EncounterSums *sums)
{
    const EncounterCoupling *coupling = &islands->coupling;
    const EncounterJoint *joints = islands->all->joints;
    double moved[2] = {0.0, 0.0};
    double speeds[2] = {0.0, 0.0};
    for (size_t n = coupling->first_partner[place]; n < coupling->first_partner[place + 1]; n++) {
        const size_t other = coupling->partners[n];
        if (!islands->is_active[other]) {
            continue;
        }
        const size_t row = joints[other].first_row;
        const size_t rows = joints[other].row_count;
        const double *block = coupling->block(coupling->context, place, other);
        for (size_t i = 0; i < 2; i++) {
            for (size_t k = 0; k < rows; k++) {
                const double mobility =
                    place > other ? block[i * rows + k] : block[k * joints[place].row_count + i];
                moved[i] += mobility * sums->moment[row + k];
                speeds[i] += mobility * sums->impulse[row + k];
            }
        }
    }
    return encounter_motion_flight(islands->all, place, time_s, moved, speeds);
}

EncounterPose encounter_islands_pose(const EncounterIslands *islands, size_t place, double time_s,
                                     const EncounterSums *sums)
{
    if (!islands->is_active[place]) {
        return (EncounterPose){.pose = flying_pose(islands, place, time_s, sums)};
    }
    const EncounterIsland *island = islands->islands[islands->island_of[place]];
    return encounter_pose(&island->encounter, islands->number_in[place], island->node,
                          island->look_s, &island->sums);
}

// Integrates many contacts in islands: those together that feel each other within a step, and large
// islands in blocks.
//
// Every contact that begins or ends cuts the local steps of an island, so that one of n contacts
// takes the time of n^2. What a contact does to those next to it is, in a step,
//     u'' = g + W f + W_o f_o
// with f_o the forces of the contacts outside its block. Blocks are run one after the other under
// the f_o of the last run of each of the others (waveform relaxation, Gauss-Seidel), and again
// while one of these has changed by more than the local steps' tolerance. With w the frequency of a
// contact and h the step, k rounds leave (w h)^(2 k) / (2 k)! of the coupling: it converges
// for any h, and quickly for w h of a few rad. Where it takes too many rounds the island is run as
// a whole. Contacts of others that begin or end in the step end local steps of the block; smooth
// changes do not. So the result is that of the whole, at other local steps.
//
// Source: Lelarasmee, Ruehli and Sangiovanni-Vincentelli, IEEE Trans. CAD 1 (1982) 131.
//
// A contact may touch in a step if its gap is no longer than
//     h (|u'| + sum |W| V) + h^2 |g| / 2
// with V how much the impulses of its partners vary in the step, and W their mobilities. First V is
// taken to be zero; once the islands are run it is known. Contacts that may touch now are active as
// well, and islands that have grown by them are run again, from the start of the step.
#include "kernel/internal.h"

#include "base/union_find.h"
#include "base/zeroed.h"

#include <math.h>
#include <string.h>

static void fill_between(Kernel *kernel, const double *block, size_t a, size_t b)
{
    const KernelContact *of = &kernel->contacts[a];
    const KernelContact *other = &kernel->contacts[b];
    for (size_t i = 0; i < of->row_count; i++) {
        double *row = kernel_mobility(kernel, of->first_row + i, other->first_row);
        for (size_t k = 0; k < other->row_count; k++) {
            row[k] = block[i * other->row_count + k];
            *kernel_mobility(kernel, other->first_row + k, of->first_row + i) = row[k];
        }
    }
}

// The number of a contact among sorted ones, or `count`.
static size_t find_in_island(const size_t *members, size_t count, size_t member)
{
    size_t low = 0;
    size_t high = count;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (members[middle] <= member) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return count > 0 && members[low] == member ? low : count;
}

void kernel_fill(Kernel *kernel, const KernelCoupling *coupling, const size_t *members)
{
    for (size_t a = 0; a < kernel->contact_count; a++) {
        const size_t member = members == NULL ? a : members[a];
        for (size_t n = coupling->first_partner[member]; n < coupling->first_partner[member + 1];
             n++) {
            const size_t other = coupling->partners[n];
            const size_t b = members == NULL ? other : find_in_island(members, a + 1, other);
            if (b > a) {
                continue;
            }
            fill_between(kernel, coupling->block(coupling->context, member, other), a, b);
        }
    }
}

size_t kernel_coupling_reach(const KernelCoupling *coupling, const Kernel *kernel,
                             const size_t *members)
{
    size_t reach = 0;
    for (size_t a = 0; a < kernel->contact_count; a++) {
        const KernelContact *contact = &kernel->contacts[a];
        for (size_t n = coupling->first_partner[members[a]];
             n < coupling->first_partner[members[a] + 1] && coupling->partners[n] <= members[a];
             n++) {
            const size_t b = find_in_island(members, a + 1, coupling->partners[n]);
            if (b <= a) {
                const size_t apart =
                    contact->first_row + contact->row_count - 1 - kernel->contacts[b].first_row;
                reach = apart > reach ? apart : reach;
                break;
            }
        }
    }
    return reach;
}

// How fast impulses that vary so in the rows of one contact may make another one at most, m/s; both
// are numbers among all contacts.
static double find_push(const KernelCoupling *coupling, const Kernel *all, size_t from,
                        const double *variations, size_t to)
{
    const size_t rows = all->contacts[from].row_count;
    const size_t own = all->contacts[to].row_count;
    const double *block = coupling->block(coupling->context, to, from);
    double sums[2] = {0.0, 0.0};
    for (size_t i = 0; i < 2; i++) {
        for (size_t k = 0; k < rows; k++) {
            sums[i] += fabs(to > from ? block[i * rows + k] : block[k * own + i]) * variations[k];
        }
    }
    return hypot(sums[0], sums[1]);
}

// Makes an island of so many of the contacts, which it takes over.
static KernelIsland *make_island(const KernelIslands *islands, size_t *members, size_t count)
{
    const Kernel *all = islands->all;
    KernelIsland *island = zeroed(1, sizeof *island);
    Kernel *kernel = &island->kernel;
    *kernel = kernel_start(all->phase);
    kernel->duration_before_s = islands->duration_before_s;
    island->members = members;
    for (size_t i = 0; i < count; i++) {
        const KernelContact *contact = &all->contacts[members[i]];
        kernel_add(kernel, contact, contact->row_count);
        for (size_t k = 0; contact->state.is_touching && k < 2; k++) {
            kernel->longest_s[k] = fmin(kernel->longest_s[k], islands->longest_s[members[i]][k]);
        }
    }
    kernel_make_room(kernel, kernel_coupling_reach(&islands->coupling, kernel, members));
    island->sums = kernel_sums(kernel->row_count);
    return island;
}

static void free_island(KernelIsland *island)
{
    if (island != NULL) {
        kernel_finish(&island->kernel);
        kernel_sums_free(&island->sums);
        kernel_input_destroy(island->input);
        free(island->is_boundary);
        free(island->members);
        free(island);
    }
}

// Gives an island the state of its contacts at the start of the step.
static void start_island(const KernelIslands *islands, KernelIsland *island)
{
    const Kernel *all = islands->all;
    Kernel *kernel = &island->kernel;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *from = &all->contacts[island->members[i]];
        KernelContact *contact = &kernel->contacts[i];
        const size_t first = contact->first_row;
        const size_t size = contact->row_count * sizeof(double);
        *contact = *from;
        contact->first_row = first;
        memcpy(kernel->position + first, all->position + from->first_row, size);
        memcpy(kernel->speed + first, all->speed + from->first_row, size);
        memcpy(kernel->free + first, all->free + from->first_row, size);
    }
    kernel->duration_before_s = islands->duration_before_s;
    kernel_fill(kernel, &islands->coupling, island->members);
}

enum {
    CLUSTER_CONTACTS_MOST = 4, // contacts of a block at most, but for more of one joint
    ROUNDS_MOST = 40,          // after which an island is run as a whole
    PATIENCE_LEAST = 3, // steps in which an island is divided before it is tried as a whole again
    PATIENCE_MOST = 15,
};

// Adds a contact with all others of its joint to a cluster, and to the queue.
static void cluster_joint(const Kernel *all, size_t member, size_t cluster, size_t *cluster_of,
                          size_t *queue, size_t *queued)
{
    size_t first = member;
    while (first > 0 && all->contacts[first - 1].joint == all->contacts[member].joint) {
        first--;
    }
    for (size_t i = first;
         i < all->contact_count && all->contacts[i].joint == all->contacts[member].joint; i++) {
        cluster_of[i] = cluster;
        queue[(*queued)++] = i;
    }
}

// The clusters that contacts are sorted into once and for all: those of one joint, and neighbours
// of neighbours. Owned by the caller.
static size_t *find_clusters(const Kernel *all, const KernelCoupling *coupling)
{
    const size_t count = all->contact_count;
    size_t *cluster_of = zeroed(count, sizeof *cluster_of);
    size_t *queue = zeroed(count, sizeof *queue);
    size_t queued = 0;
    size_t next = 0;
    size_t cluster = 0;
    size_t begun = 0; // contacts before those of the cluster
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
                if (queued - begun >= CLUSTER_CONTACTS_MOST) {
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

// Finds the contacts of islands that are large, and have or had too much going on.
static bool choose_divided(KernelIslands *islands)
{
    const size_t count = islands->all->contact_count;
    size_t *sizes = zeroed(count, sizeof *sizes);
    bool is_any = false;
    for (size_t i = 0; i < count; i++) {
        islands->parents[i] = union_find_root(islands->joined, i);
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

// Divides islands that are large: of contacts that belong together, those of one cluster stay so.
static void divide_islands(KernelIslands *islands)
{
    const KernelCoupling *coupling = &islands->coupling;
    const size_t count = islands->all->contact_count;
    if (!choose_divided(islands)) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        islands->joined[i] = islands->is_divided[i] ? i : islands->joined[i];
    }
    for (size_t i = 0; i < count; i++) {
        for (size_t n = coupling->first_partner[i];
             islands->is_divided[i] && n < coupling->first_partner[i + 1]; n++) {
            const size_t partner = coupling->partners[n];
            if (islands->is_active[partner] && islands->clusters[partner] == islands->clusters[i]) {
                union_find_join(islands->joined, i, partner);
            }
        }
    }
}

// Adds what one contact outside does to a contact of a block. Returns whether it is outside.
static bool connect_partner(KernelIslands *islands, KernelIsland *island, size_t number,
                            size_t partner)
{
    const KernelCoupling *coupling = &islands->coupling;
    const size_t member = island->members[number];
    KernelInput *input = island->input;
    if (!islands->is_active[partner] || islands->island_of[partner] == islands->island_of[member]) {
        return false;
    }
    const KernelTrack *track = &islands->tracks[partner];
    size_t source = 0;
    while (source < input->source_count && input->sources[source] != track) {
        source++;
    }
    if (source == input->source_count) {
        kernel_input_add(input, track);
    }
    const KernelContact *contact = &island->kernel.contacts[number];
    const KernelLink link = {
        .source = source,
        .row = contact->first_row,
        .rows = contact->row_count,
        .mobility = coupling->block(coupling->context, member, partner),
        .is_transposed = member < partner,
    };
    kernel_input_link(input, &link);
    return true;
}

static void connect_block(KernelIslands *islands, KernelIsland *island)
{
    const KernelCoupling *coupling = &islands->coupling;
    const size_t count = island->kernel.contact_count;
    if (island->input == NULL) {
        island->input = kernel_input_create(island->kernel.row_count);
        island->is_boundary = zeroed(count, sizeof *island->is_boundary);
    }
    KernelInput *input = island->input;
    // versions of tracks that a block has been run with already
    const KernelInput before = *input;
    input->sources = NULL;
    input->versions = NULL;
    input->source_room = input->version_room = 0;
    kernel_input_clear(input);
    for (size_t i = 0; i < count; i++) {
        const size_t *first = coupling->first_partner + island->members[i];
        const bool was_boundary = island->is_boundary[i];
        island->is_boundary[i] = false;
        for (size_t n = first[0]; n < first[1]; n++) {
            const bool is_outside = connect_partner(islands, island, i, coupling->partners[n]);
            island->is_boundary[i] = island->is_boundary[i] || is_outside;
        }
        if (island->is_run && island->is_boundary[i] && !was_boundary) {
            kernel_track_write(&islands->tracks[island->members[i]], &island->kernel, i);
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
    island->kernel.input = input;
}

// Connects the islands that are blocks of a larger one with the tracks of the others.
static void connect_blocks(KernelIslands *islands)
{
    for (size_t i = 0; i < islands->count; i++) {
        KernelIsland *island = islands->islands[i];
        island->kernel.input = NULL;
        if (islands->is_divided[island->members[0]]) {
            connect_block(islands, island);
        }
    }
}

// Begins a step: no track says anything.
static void begin_blocks(KernelIslands *islands)
{
    for (size_t i = 0; i < islands->all->contact_count; i++) {
        kernel_track_clear(&islands->tracks[i]);
        islands->is_kept_whole[i] = islands->is_to_divide[i] = false;
        islands->waits[i] -= islands->waits[i] > 0 ? 1 : 0;
    }
}

// Runs an island through a step, from its start.
typedef bool RunIsland(KernelIslands *islands, KernelIsland *island, double duration);

typedef enum BlocksEnd {
    BLOCKS_DONE,
    BLOCKS_ANEW,   // some island is to be divided, or not to be: make islands anew
    BLOCKS_FAILED, // too many local steps
} BlocksEnd;

// Whether a block has to be run: for the first time, or under what others do now.
static bool is_due(const KernelIsland *island)
{
    return !island->is_run ||
           (island->kernel.input != NULL && kernel_input_has_changed(island->kernel.input));
}

// Runs a block from the start of the step with the lengths of local steps that it began with.
static bool run_block(KernelIslands *islands, KernelIsland *island, RunIsland *run, double duration)
{
    Kernel *kernel = &island->kernel;
    if (island->is_run) {
        memcpy(kernel->longest_s, island->longest_s, sizeof kernel->longest_s);
        kernel->stiff_width_s = island->stiff_width_s;
    } else {
        memcpy(island->longest_s, kernel->longest_s, sizeof kernel->longest_s);
        island->stiff_width_s = kernel->stiff_width_s;
    }
    kernel->event_most = SIZE_MAX;
    kernel_input_take(kernel->input);
    if (!run(islands, island, duration)) {
        return false;
    }
    for (size_t i = 0; i < kernel->contact_count; i++) {
        if (island->is_boundary[i]) {
            kernel_track_write(&islands->tracks[island->members[i]], kernel, i);
        }
    }
    return true;
}

// Runs an island that is not divided. One that has too many events is to be, in this step and in
// more after it than the last time.
static BlocksEnd run_whole(KernelIslands *islands, KernelIsland *island, RunIsland *run,
                           double duration)
{
    Kernel *kernel = &island->kernel;
    const size_t *members = island->members;
    const bool may_be_divided =
        kernel->contact_count > islands->undivided_most && !islands->is_kept_whole[members[0]];
    kernel->event_most = may_be_divided ? islands->events_most : SIZE_MAX;
    if (run(islands, island, duration)) {
        for (size_t i = 0; i < kernel->contact_count; i++) {
            islands->patience[members[i]] = 0;
        }
        return BLOCKS_DONE;
    }
    if (kernel->event_count <= kernel->event_most) {
        return BLOCKS_FAILED;
    }
    const unsigned patience = 2 * islands->patience[members[0]] + PATIENCE_LEAST;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        islands->patience[members[i]] = patience < PATIENCE_MOST ? patience : PATIENCE_MOST;
        islands->waits[members[i]] = islands->patience[members[i]];
        islands->is_to_divide[members[i]] = true;
    }
    return BLOCKS_ANEW;
}

// Keeps the islands whole whose blocks do not agree.
static BlocksEnd give_up(KernelIslands *islands)
{
    for (size_t i = 0; i < islands->count; i++) {
        const KernelIsland *island = islands->islands[i];
        if (is_due(island)) {
            const size_t parent = islands->parents[island->members[0]];
            for (size_t k = 0; k < islands->all->contact_count; k++) {
                islands->is_kept_whole[k] =
                    islands->is_kept_whole[k] || islands->parents[k] == parent;
            }
        }
    }
    return BLOCKS_ANEW;
}

// Runs the islands that are not run yet, and blocks until they agree.
static BlocksEnd run_blocks(KernelIslands *islands, RunIsland *run, double duration)
{
    BlocksEnd end = BLOCKS_DONE;
    for (size_t round = 0; round < ROUNDS_MOST; round++) {
        bool is_any = false;
        for (size_t i = 0; i < islands->count; i++) {
            KernelIsland *island = islands->islands[i];
            if (!is_due(island)) {
                continue;
            }
            if (island->kernel.input == NULL) {
                const BlocksEnd whole = run_whole(islands, island, run, duration);
                if (whole == BLOCKS_FAILED) {
                    return whole;
                }
                end = whole == BLOCKS_ANEW ? whole : end;
            } else if (!run_block(islands, island, run, duration)) {
                return BLOCKS_FAILED;
            } else {
                is_any = true;
            }
        }
        if (!is_any || end == BLOCKS_ANEW) {
            return end;
        }
    }
    return give_up(islands);
}

KernelIslands *kernel_islands_create(Kernel *all, const KernelCoupling *coupling)
{
    const size_t count = all->contact_count;
    KernelIslands *islands = zeroed(1, sizeof *islands);
    islands->all = all;
    islands->coupling = *coupling;
    islands->islands = zeroed(count, sizeof *islands->islands);
    islands->kept = zeroed(count, sizeof *islands->kept);
    islands->island_of = zeroed(count, sizeof *islands->island_of);
    islands->number_in = zeroed(count, sizeof *islands->number_in);
    islands->is_active = zeroed(count, sizeof *islands->is_active);
    islands->pushes = zeroed(count, sizeof *islands->pushes);
    islands->joined = zeroed(count, sizeof *islands->joined);
    islands->longest_s = zeroed(count, sizeof *islands->longest_s);
    islands->undivided_most = KERNEL_UNDIVIDED_MOST;
    islands->events_most = KERNEL_UNDIVIDED_EVENTS_MOST;
    islands->clusters = find_clusters(all, coupling);
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

void kernel_islands_destroy(KernelIslands *islands)
{
    if (islands == NULL) {
        return;
    }
    for (size_t i = 0; i < islands->all->contact_count; i++) {
        free_island(islands->kept[i]);
        kernel_track_finish(&islands->tracks[i]);
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
    free(islands->joined);
    free(islands->longest_s);
    free(islands);
}

// One that begins with a contact, if it is kept: it is made anew of the same contacts.
static void carry_island(KernelIslands *islands, size_t first, Carry *carry)
{
    KernelIsland *island = islands->kept[first];
    size_t count = island != NULL ? island->kernel.contact_count : 0;
    CARRY(carry, count);
    if (carry->is_back) {
        free_island(island);
        islands->kept[first] = NULL;
    }
    if (count == 0) {
        return;
    }
    size_t *members = carry->is_back ? zeroed(count, sizeof *members) : island->members;
    CARRY_ARRAY(carry, members, count);
    if (carry->is_back) {
        island = islands->kept[first] = make_island(islands, members, count);
    }
    kernel_carry(&island->kernel, carry);
}

void kernel_islands_carry(KernelIslands *islands, Carry *carry)
{
    const size_t count = islands->all->contact_count;
    kernel_carry(islands->all, carry);
    CARRY_ARRAY(carry, islands->longest_s, count);
    CARRY_ARRAY(carry, islands->waits, count);
    CARRY_ARRAY(carry, islands->patience, count);
    CARRY(carry, islands->duration_before_s);
    for (size_t i = 0; i < count; i++) {
        carry_island(islands, i, carry);
    }
}

// Whether a contact that does not touch may do so in a step of a length while others push it, m/s.
static bool may_touch(const Kernel *all, const KernelContact *contact, double duration, double push)
{
    const size_t row = contact->first_row;
    const double *position = all->position + row;
    const double *speed = all->speed + row;
    const double *free = all->free + row;
    const double half_s = 0.5 * duration;
    if (contact->shape == KERNEL_LINE) {
        return position[0] <= duration * (push + fabs(speed[0]) + half_s * fabs(free[0]));
    }
    const double beyond = fmax(fabs(position[1]) - contact->half_length, 0.0); // of a slot's end
    const double size = hypot(position[0], beyond);
    const double gap = contact->shape == KERNEL_DISC ? contact->radial_clearance + size
                                                     : contact->radial_clearance - size;
    const double fastest = push + hypot(speed[0], speed[1]) + half_s * hypot(free[0], free[1]);
    return gap <= duration * fastest;
}

// Finds which contacts belong together: the root of each is the first of them.
static void join_partners(KernelIslands *islands)
{
    const KernelCoupling *coupling = &islands->coupling;
    const size_t count = islands->all->contact_count;
    union_find_start(islands->joined, count);
    for (size_t i = 0; i < count; i++) {
        for (size_t n = coupling->first_partner[i];
             islands->is_active[i] && n < coupling->first_partner[i + 1]; n++) {
            const size_t partner = coupling->partners[n];
            if (islands->is_active[partner]) {
                union_find_join(islands->joined, i, partner);
            }
        }
    }
}

// Sorts the active contacts into islands: their numbers, and those of each island's contacts.
static size_t *number_active(KernelIslands *islands)
{
    const size_t count = islands->all->contact_count;
    size_t *sizes = zeroed(count, sizeof *sizes);
    islands->count = 0;
    for (size_t i = 0; i < count; i++) {
        islands->island_of[i] = count;
        if (islands->is_active[i]) {
            const size_t leader = union_find_root(islands->joined, i);
            const size_t number = leader == i ? islands->count++ : islands->island_of[leader];
            islands->island_of[i] = number;
            islands->number_in[i] = sizes[number]++;
        }
    }
    return sizes;
}

// Whether an island consists of those contacts.
static bool is_same(const KernelIsland *island, const size_t *members, size_t count)
{
    return island != NULL && island->kernel.contact_count == count &&
           memcmp(island->members, members, count * sizeof *members) == 0;
}

// The contacts of a joint are active together: what it does is the sum of what they do, and how
// stiff one is depends on the others.
static void activate_joints(KernelIslands *islands)
{
    const KernelContact *contacts = islands->all->contacts;
    const size_t count = islands->all->contact_count;
    for (size_t first = 0, end; first < count; first = end) {
        bool is_any = false;
        for (end = first; end < count && contacts[end].joint == contacts[first].joint; end++) {
            is_any = is_any || islands->is_active[end];
        }
        for (size_t i = first; i < end; i++) {
            islands->is_active[i] = is_any;
        }
    }
}

// Makes the islands of the contacts that are active now; those that are as they were stay.
static void make_islands(KernelIslands *islands)
{
    const size_t count = islands->all->contact_count;
    activate_joints(islands);
    join_partners(islands);
    divide_islands(islands);
    size_t *sizes = number_active(islands);
    size_t **members = zeroed(islands->count, sizeof *members);
    for (size_t i = 0; i < islands->count; i++) {
        members[i] = zeroed(sizes[i], sizeof *members[i]);
    }
    for (size_t i = 0; i < count; i++) {
        if (islands->is_active[i]) {
            members[islands->island_of[i]][islands->number_in[i]] = i;
        }
    }
    for (size_t i = 0; i < islands->count; i++) {
        KernelIsland **kept = &islands->kept[members[i][0]];
        if (is_same(*kept, members[i], sizes[i])) {
            free(members[i]);
        } else {
            free_island(*kept);
            *kept = make_island(islands, members[i], sizes[i]);
        }
        islands->islands[i] = *kept;
    }
    free(members);
    free(sizes);
    connect_blocks(islands);
}

// How much the impulses in an island's rows vary in the step.
static void find_variations(const Kernel *kernel, double *variations)
{
    const size_t rows = kernel->row_count;
    memset(variations, 0, rows * sizeof *variations);
    for (size_t node = 0; node + 1 < kernel->node_count; node++) {
        const double *impulse = kernel_node_values(kernel, node);
        for (size_t row = 0; row < rows; row++) {
            variations[row] += fabs(impulse[4 * rows + row] - impulse[row]);
        }
    }
}

// Adds what an island does to contacts that fly.
static void add_pushes(KernelIslands *islands, const KernelIsland *island)
{
    const KernelCoupling *coupling = &islands->coupling;
    const Kernel *kernel = &island->kernel;
    double *variations = kernel->work->speeds;
    find_variations(kernel, variations);
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const size_t member = island->members[i];
        for (size_t n = coupling->first_partner[member]; n < coupling->first_partner[member + 1];
             n++) {
            const size_t other = coupling->partners[n];
            if (!islands->is_active[other]) {
                islands->pushes[other] +=
                    find_push(coupling, islands->all, member,
                              variations + kernel->contacts[i].first_row, other);
            }
        }
    }
}

// Makes the contacts active that may touch after all. Returns whether there are any.
static bool activate(KernelIslands *islands, double duration)
{
    const Kernel *all = islands->all;
    bool is_any = false;
    for (size_t i = 0; i < islands->count; i++) {
        add_pushes(islands, islands->islands[i]);
    }
    for (size_t i = 0; i < all->contact_count; i++) {
        if (islands->pushes[i] > 0.0 &&
            may_touch(all, &all->contacts[i], duration, islands->pushes[i])) {
            islands->is_active[i] = is_any = true;
        }
        islands->pushes[i] = 0.0;
    }
    return is_any;
}

// Hands what lives on from step to step back to all contacts. Islands of other steps are of no use.
static void keep_states(KernelIslands *islands, double duration)
{
    Kernel *all = islands->all;
    for (size_t i = 0; i < all->contact_count; i++) {
        KernelContact *contact = &all->contacts[i];
        if (islands->kept[i] != NULL && !islands->kept[i]->is_run) {
            free_island(islands->kept[i]);
            islands->kept[i] = NULL;
        }
        if (!islands->is_active[i]) {
            const double *own = islands->coupling.block(islands->coupling.context, i, i);
            contact->mobility_before[0] = own[0];
            contact->mobility_before[1] = own[1];
            contact->mobility_before[2] = own[contact->row_count + 1];
            continue;
        }
        const Kernel *kernel = &islands->islands[islands->island_of[i]]->kernel;
        const size_t first = contact->first_row;
        *contact = kernel->contacts[islands->number_in[i]];
        contact->first_row = first;
        memcpy(islands->longest_s[i], kernel->longest_s, sizeof kernel->longest_s);
    }
    islands->duration_before_s = duration;
}

static bool run_island(KernelIslands *islands, KernelIsland *island, double duration)
{
    const size_t before = island->kernel.evaluations;
    start_island(islands, island);
    if (!kernel_run(&island->kernel, duration)) {
        return false;
    }
    island->is_run = true;
    islands->all->evaluations += island->kernel.evaluations - before;
    return true;
}

bool kernel_islands_run(KernelIslands *islands, double duration)
{
    Kernel *all = islands->all;
    for (size_t i = 0; i < all->contact_count; i++) {
        islands->is_active[i] =
            all->contacts[i].state.is_touching || may_touch(all, &all->contacts[i], duration, 0.0);
        if (islands->kept[i] != NULL) {
            islands->kept[i]->is_run = false;
        }
    }
    begin_blocks(islands);
    BlocksEnd end;
    do {
        make_islands(islands);
        end = run_blocks(islands, run_island, duration);
        if (end == BLOCKS_FAILED) {
            return false;
        }
    } while (end == BLOCKS_ANEW || activate(islands, duration));
    keep_states(islands, duration);
    return true;
}

void kernel_island_look(KernelIsland *island, size_t node, double time_s)
{
    island->node = node;
    island->look_s = time_s;
    kernel_at(&island->kernel, node, time_s, &island->sums);
}

void kernel_island_look_around(KernelIsland *island, size_t number, size_t node, double time_s)
{
    island->node = node;
    island->look_s = time_s;
    kernel_around(&island->kernel, number, node, time_s, &island->sums);
}

void kernel_islands_look(KernelIslands *islands, double time_s, KernelSums *sums)
{
    const Kernel *all = islands->all;
    memset(sums->impulse, 0, all->row_count * sizeof *sums->impulse);
    memset(sums->moment, 0, all->row_count * sizeof *sums->moment);
    memset(sums->force, 0, all->row_count * sizeof *sums->force);
    sums->dissipated = sums->friction = 0.0;
    for (size_t i = 0; i < islands->count; i++) {
        KernelIsland *island = islands->islands[i];
        const Kernel *kernel = &island->kernel;
        kernel_island_look(island, kernel_node(kernel, time_s), time_s);
        for (size_t k = 0; k < kernel->contact_count; k++) {
            const KernelContact *contact = &kernel->contacts[k];
            const size_t row = all->contacts[island->members[k]].first_row;
            const size_t size = contact->row_count * sizeof(double);
            memcpy(sums->impulse + row, island->sums.impulse + contact->first_row, size);
            memcpy(sums->moment + row, island->sums.moment + contact->first_row, size);
            memcpy(sums->force + row, island->sums.force + contact->first_row, size);
        }
        sums->dissipated += island->sums.dissipated;
        sums->friction += island->sums.friction;
    }
}

// How a contact that flies is pushed by the impulses of others, of which the sums are given.
static PinHole flying_pose(const KernelIslands *islands, size_t member, double time_s,
                           const KernelSums *sums)
{
    const KernelCoupling *coupling = &islands->coupling;
    const KernelContact *contacts = islands->all->contacts;
    double moved[2] = {0.0, 0.0};
    double speeds[2] = {0.0, 0.0};
    for (size_t n = coupling->first_partner[member]; n < coupling->first_partner[member + 1]; n++) {
        const size_t other = coupling->partners[n];
        if (!islands->is_active[other]) {
            continue;
        }
        const size_t row = contacts[other].first_row;
        const size_t rows = contacts[other].row_count;
        const double *block = coupling->block(coupling->context, member, other);
        for (size_t i = 0; i < 2; i++) {
            for (size_t k = 0; k < rows; k++) {
                const double mobility = member > other ? block[i * rows + k]
                                                       : block[k * contacts[member].row_count + i];
                moved[i] += mobility * sums->moment[row + k];
                speeds[i] += mobility * sums->impulse[row + k];
            }
        }
    }
    return kernel_motion_flight(islands->all, member, time_s, moved, speeds);
}

KernelPose kernel_islands_pose(const KernelIslands *islands, size_t member, double time_s,
                               const KernelSums *sums)
{
    if (!islands->is_active[member]) {
        return (KernelPose){.pose = flying_pose(islands, member, time_s, sums)};
    }
    const KernelIsland *island = islands->islands[islands->island_of[member]];
    return kernel_pose(&island->kernel, islands->number_in[member], island->node, island->look_s,
                       &island->sums);
}

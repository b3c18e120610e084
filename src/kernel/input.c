// Adds what contacts outside a kernel do to the free motion of its rows.
//
// What such a contact did in a step is its track: its kernel's own nodes, of the rows of one
// contact. A track has changed where its impulse at any node is further from that of the track
// before than the error that the local steps allow, relative to the largest impulse m v of the
// step: with v the speed at which the contact began and m the mass that gives the frequency of the
// contact's oscillation.
//
// With P, Q and f the impulses, their integrals and the forces of those contacts, and W their
// mobilities:  W Q to the positions, W P to the speeds, W f to the accelerations.
#include "kernel/internal.h"

#include "base/room.h"
#include "base/zeroed.h"

#include <math.h>

void kernel_track_finish(KernelTrack *track)
{
    free(track->times);
    free(track->values);
    free(track->stops);
    *track = (KernelTrack){.count = 0};
}

void kernel_track_clear(KernelTrack *track)
{
    track->count = track->stop_count = track->version = 0;
}

// The first of the times behind one, or the last before it, by its number; `count` where none is.
static size_t find_time(const double *times, size_t count, double time_s, bool is_before)
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
static bool is_behind_node(const KernelTrack *track, size_t node, double time_s, bool is_before)
{
    const double *times = track->times + node;
    if (node + 1 >= track->count) {
        return false;
    }
    return is_before ? times[0] < time_s && time_s <= times[1]
                     : times[0] <= time_s && time_s < times[1];
}

void kernel_track_at(const KernelTrack *track, double time_s, bool is_before, size_t *begin,
                     double *impulse, double *moment, double *force)
{
    const size_t rows = track->rows;
    if (!is_behind_node(track, *begin, time_s, is_before)) {
        const size_t behind = find_time(track->times, track->count, time_s, is_before);
        *begin = behind > 0 ? behind - 1 : 0;
    }
    const size_t node = *begin;
    const size_t next = node + 1 < track->count ? node + 1 : node;
    const double *first = track->values + 3 * rows * node;
    const double *last = track->values + 3 * rows * next;
    const double width = track->times[next] - track->times[node];
    const double s = width > 0.0 ? (time_s - track->times[node]) / width : 0.0;
    const bool is_short = width < KERNEL_LINEAR_WIDTH * track->times[track->count - 1];
    for (size_t i = 0; i < rows; i++) {
        const KernelNodeRow at = kernel_quintic(
            (KernelNodeRow){first[i], first[rows + i], first[2 * rows + i], 0.0},
            (KernelNodeRow){last[i], last[rows + i], last[2 * rows + i], 0.0}, width, s, is_short);
        impulse[i] = at.impulse;
        moment[i] = at.moment;
        force[i] = at.force;
    }
}

double kernel_track_stop(const KernelTrack *track, double after_s)
{
    const size_t at = find_time(track->stops, track->stop_count, after_s, false);
    return at < track->stop_count ? track->stops[at] : INFINITY;
}

double kernel_track_node(const KernelTrack *track, double after_s)
{
    const size_t at = find_time(track->times, track->count, after_s, false);
    return at < track->count ? track->times[at] : INFINITY;
}

// The largest change of an impulse from the track to what the kernel has now, and the largest
// impulse of both, N s.
static double find_change(const KernelTrack *track, const Kernel *kernel, size_t contact,
                          double *largest)
{
    const KernelContact *of = &kernel->contacts[contact];
    double impulse[KERNEL_ROWS_MOST] = {0.0};
    double moment[KERNEL_ROWS_MOST];
    double force[KERNEL_ROWS_MOST];
    double change = 0.0;
    size_t begin = 0;
    *largest = 0.0;
    for (size_t node = 0; node < kernel->node_count; node++) {
        const double *now = kernel_node_values(kernel, node) + of->first_row;
        if (track->count > 0) {
            kernel_track_at(track, kernel->times[node], false, &begin, impulse, moment, force);
        }
        *largest = fmax(*largest, fmax(hypot(now[0], now[1]), hypot(impulse[0], impulse[1])));
        double apart = hypot(now[0] - impulse[0], now[1] - impulse[1]);
        if (of->row_count > KERNEL_ROW_AXIAL) {
            // friction of a pin along its axis, which is in neither of the two
            apart = hypot(apart, now[KERNEL_ROW_AXIAL] - impulse[KERNEL_ROW_AXIAL]);
        }
        change = apart <= change ? change : apart; // a NaN must show
    }
    return change;
}

void kernel_track_write(KernelTrack *track, const Kernel *kernel, size_t contact)
{
    const KernelContact *of = &kernel->contacts[contact];
    const size_t rows = kernel->row_count;
    const size_t count = kernel->node_count;
    double largest;
    const double change = find_change(track, kernel, contact, &largest);
    const double met = of->frequency > 0.0 && of->state.impact_speed > 0.0
                           ? of->force_per_speed * of->state.impact_speed / of->frequency
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
        track->times[node] = kernel->times[node];
        const double *values = kernel_node_values(kernel, node);
        const double *parts[3] = {values, values + rows, kernel_node_forces(kernel, node)};
        for (size_t part = 0; part < 3; part++) {
            memcpy(track->values + (3 * node + part) * track->rows, parts[part] + of->first_row,
                   track->rows * sizeof *track->values);
        }
        if (node > 0 &&
            kernel_touches(kernel, node, contact) != kernel_touches(kernel, node - 1, contact)) {
            track->stops[track->stop_count++] = track->times[node];
        }
    }
}

// Forgets what the tracks add.
static void forget_added(KernelInput *input)
{
    for (size_t i = 0; i < KERNEL_ADDED; i++) {
        input->added[i].time_s = NAN;
    }
    input->last = input->added;
}

KernelInput *kernel_input_create(size_t rows)
{
    KernelInput *input = zeroed(1, sizeof *input);
    for (size_t i = 0; i < KERNEL_ADDED; i++) {
        KernelAdded *added = &input->added[i];
        added->position = zeroed(3 * rows, sizeof *added->position);
        added->speed = added->position + rows;
        added->acceleration = added->speed + rows;
    }
    forget_added(input);
    return input;
}

void kernel_input_destroy(KernelInput *input)
{
    if (input != NULL) {
        free(input->sources);
        free(input->versions);
        free(input->links);
        free(input->nodes);
        for (size_t i = 0; i < KERNEL_ADDED; i++) {
            free(input->added[i].position);
        }
        free(input);
    }
}

void kernel_input_clear(KernelInput *input)
{
    input->source_count = input->link_count = 0;
    forget_added(input);
}

size_t kernel_input_add(KernelInput *input, const KernelTrack *track)
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

void kernel_input_link(KernelInput *input, const KernelLink *link)
{
    input->links =
        room_grow(input->links, &input->link_room, input->link_count + 1, sizeof *input->links);
    input->links[input->link_count++] = *link;
}

bool kernel_input_has_changed(const KernelInput *input)
{
    for (size_t i = 0; i < input->source_count; i++) {
        if (input->versions[i] != input->sources[i]->version) {
            return true;
        }
    }
    return false;
}

void kernel_input_take(KernelInput *input)
{
    for (size_t i = 0; i < input->source_count; i++) {
        input->versions[i] = input->sources[i]->version;
        input->nodes[i] = 0;
    }
    forget_added(input);
}

// Adds what all tracks do at a time.
static void add_tracks(KernelInput *input, double time_s, KernelAdded *added)
{
    double impulse[KERNEL_ROWS_MOST];
    double moment[KERNEL_ROWS_MOST];
    double force[KERNEL_ROWS_MOST];
    size_t known = SIZE_MAX;
    for (size_t n = 0; n < input->link_count; n++) {
        const KernelLink *link = &input->links[n];
        const KernelTrack *track = input->sources[link->source];
        if (track->count == 0) {
            continue;
        }
        if (known != link->source) {
            kernel_track_at(track, time_s, input->is_before, &input->nodes[link->source], impulse,
                            moment, force);
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

const KernelAdded *kernel_input_find(KernelInput *input, size_t row_count, double time_s)
{
    for (size_t i = 0; i < KERNEL_ADDED; i++) {
        KernelAdded *added = &input->added[i];
        if (added->time_s == time_s && added->is_before == input->is_before) {
            return input->last = added;
        }
    }
    KernelAdded *added = &input->added[input->oldest];
    input->oldest = (input->oldest + 1) % KERNEL_ADDED;
    memset(added->position, 0, 3 * row_count * sizeof *added->position);
    add_tracks(input, time_s, added);
    added->time_s = time_s;
    added->is_before = input->is_before;
    return input->last = added;
}

void kernel_input_look(const Kernel *kernel, bool is_before)
{
    if (kernel->input != NULL) {
        kernel->input->is_before = is_before;
    }
}

double kernel_input_stop(const Kernel *kernel, double after_s)
{
    double first_s = INFINITY;
    for (size_t i = 0; kernel->input != NULL && i < kernel->input->source_count; i++) {
        first_s = fmin(first_s, kernel_track_stop(kernel->input->sources[i], after_s));
    }
    return first_s;
}

double kernel_input_node(const Kernel *kernel, double after_s)
{
    double first_s = INFINITY;
    for (size_t i = 0; kernel->input != NULL && i < kernel->input->source_count; i++) {
        first_s = fmin(first_s, kernel_track_node(kernel->input->sources[i], after_s));
    }
    return first_s;
}

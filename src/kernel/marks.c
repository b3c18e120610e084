// Finds the instants within a step at which a contact that was integrated inside it stands out.
//
// Depth: greatest where its rate passes zero, which is nearly linear between two nodes. Force:
// greatest on the parabola through three nodes. Both positions are right to the second order of the
// local step, the values there to the fourth.
#include "kernel/marks.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// Marks of a step that each have a part of it.
enum { MARKS_FEW = 16 };

// Of the step: the maxima of one swing, of which a step holds a few at most, are too low by the
// square of this where they are seen so much too early or too late.
static const double ALIKE = 1e-4;

static void add_mark(Marks *marks, double time_s, size_t node, bool is_peak)
{
    if (marks->count == marks->room) {
        marks->room = 2 * marks->room + 16;
        marks->marks = realloc(marks->marks, marks->room * sizeof *marks->marks);
        assert(marks->marks != NULL);
    }
    // two in one interval may come in either order
    size_t at = marks->count++;
    while (at > 0 && marks->marks[at - 1].time_s > time_s) {
        marks->marks[at] = marks->marks[at - 1];
        at--;
    }
    marks->marks[at] = (Mark){time_s, node, is_peak};
}

// The square of a joint's force at a node.
static double force_squared(const Kernel *kernel, size_t joint, size_t node)
{
    const double *force = kernel_node_forces(kernel, node) + kernel->contacts[joint].first_row;
    return force[0] * force[0] + force[1] * force[1];
}

// The time of a maximum of the force that node `middle` is nearest to, or NAN.
static double force_peak(const Kernel *kernel, size_t joint, size_t middle)
{
    if (middle == 0 || middle + 1 >= kernel->node_count ||
        !kernel_touches(kernel, middle - 1, joint) || !kernel_touches(kernel, middle, joint)) {
        return NAN;
    }
    const double squares[3] = {
        force_squared(kernel, joint, middle - 1),
        force_squared(kernel, joint, middle),
        force_squared(kernel, joint, middle + 1),
    };
    const double *t = kernel->times + middle - 1;
    if (!(squares[1] > squares[0] && squares[1] >= squares[2] && t[1] > t[0] && t[2] > t[1])) {
        return NAN;
    }
    const double rise = sqrt(squares[1]) - sqrt(squares[0]);
    const double fall = sqrt(squares[1]) - sqrt(squares[2]);
    // the slopes of the chords stand at their middles; in between the slope is linear
    const double up = rise / (t[1] - t[0]);
    const double down = fall / (t[2] - t[1]);
    return 0.5 * (t[0] + t[1]) + 0.5 * (t[2] - t[0]) * up / (up + down);
}

// The maxima of one joint in the interval behind a node.
static void mark_maxima(Marks *marks, const Kernel *kernel, size_t joint, size_t node)
{
    const double start_s = kernel->times[node];
    const double end_s = kernel->times[node + 1];
    const size_t count = kernel->contact_count;
    const double before = kernel->closings[node * count + joint];
    const double behind = kernel->closings[(node + 1) * count + joint];
    if (before > 0.0 && behind <= 0.0) {
        add_mark(marks, start_s + (end_s - start_s) * before / (before - behind), node, true);
    }
    const double peaks[2] = {force_peak(kernel, joint, node), force_peak(kernel, joint, node + 1)};
    for (int i = 0; i < 2; i++) {
        if (peaks[i] >= start_s && peaks[i] < end_s) {
            add_mark(marks, peaks[i], node, true);
        }
    }
}

// Whether a joint touches from a node on that did not from another on.
static bool is_any_new(const Kernel *kernel, size_t behind, size_t node)
{
    for (size_t i = 0; i < kernel->contact_count; i++) {
        if (kernel_touches(kernel, behind, i) && !kernel_touches(kernel, node, i)) {
            return true;
        }
    }
    return false;
}

// The maxima in the interval behind a node.
static void mark_interval(Marks *marks, const Kernel *kernel, size_t node)
{
    if (!kernel_touches_any(kernel, node)) {
        return;
    }
    for (size_t joint = 0; joint < kernel->contact_count; joint++) {
        if (kernel_touches(kernel, node, joint)) {
            mark_maxima(marks, kernel, joint, node);
        }
    }
}

// The last of the nodes at one time.
static size_t last_at_once(const Kernel *kernel, size_t node)
{
    while (node + 1 < kernel->node_count && kernel->times[node + 1] == kernel->times[node]) {
        node++;
    }
    return node;
}

// Leaves out the maxima that come so soon behind another one.
static void thin(Marks *marks, double alike_s)
{
    size_t kept = 0;
    double top_s = -INFINITY;
    for (size_t i = 0; i < marks->count; i++) {
        const Mark mark = marks->marks[i];
        if (mark.is_peak && mark.time_s - top_s < alike_s) {
            continue;
        }
        top_s = mark.is_peak ? mark.time_s : top_s;
        marks->marks[kept++] = mark;
    }
    marks->count = kept;
}

void marks_find(Marks *marks, const Kernel *kernel)
{
    marks->count = 0;
    marks->next = 0;
    const size_t last = kernel->node_count - 1;
    for (size_t node = 0; node < last; node++) {
        const size_t behind = last_at_once(kernel, node);
        if (behind > node) {
            // contacts end or begin, maybe several: the part before them ends here, and at an onset
            // a damper may press hardest
            add_mark(marks, kernel->times[node], node > 0 ? node - 1 : node, false);
            if (is_any_new(kernel, behind, node)) {
                add_mark(marks, kernel->times[node], behind, false);
            }
            if (behind == last) {
                break;
            }
            node = behind;
        }
        mark_interval(marks, kernel, node);
    }
    // what begins or ends at the very end has done so
    const bool is_inside = last > 0 && kernel->times[last - 1] < kernel->times[last];
    add_mark(marks, kernel->times[last], is_inside ? last - 1 : last, false);
    if (marks->count > MARKS_FEW) {
        thin(marks, ALIKE * (kernel->times[last] - kernel->times[0]));
    }
}

void marks_finish(Marks *marks)
{
    free(marks->marks);
    *marks = (Marks){.count = 0};
}

// Says what a part of a step holds of the contacts that were integrated inside it, and where parts
// end.
//
// Depth: greatest where its rate passes zero, which is nearly linear between two nodes. Force:
// greatest on the parabola through three nodes. Both positions are right to the second order of the
// local step, the values there to the fourth.
#include "ode/impulse.h"

#include "base/zeroed.h"

#include <math.h>
#include <string.h>

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
        if (kernel_touches(kernel, node, joint) && !kernel->contacts[joint].is_rub) {
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

void impulse_part_init(ImpulsePart *part, const Linkage *linkage, size_t rows)
{
    part->sums = kernel_sums(rows);
    part->before = kernel_sums(rows);
    part->omega = zeroed(linkage->body_count, sizeof *part->omega);
    part->alpha = zeroed(linkage->body_count, sizeof *part->alpha);
    part->impulse = zeroed(linkage->joint_count, sizeof *part->impulse);
    part->approach = zeroed(linkage->joint_count, sizeof *part->approach);
    part->since_s = zeroed(linkage->joint_count, sizeof *part->since_s);
    part->is_known = zeroed(linkage->joint_count, sizeof *part->is_known);
}

bool impulse_part_needs_step(const ImpulsePart *part)
{
    return part->marks.next == part->marks.count;
}

void impulse_part_begin(ImpulsePart *part, const Kernel *kernel, double start_s)
{
    marks_find(&part->marks, kernel);
    const size_t rows = kernel_rows(kernel);
    memset(part->sums.impulse, 0, rows * sizeof *part->sums.impulse);
    part->sums.dissipated = part->sums.friction = 0.0;
    part->end_s = start_s;
}

const Mark *impulse_part_next(ImpulsePart *part, const Kernel *kernel, double step_start_s,
                              double step_end_s)
{
    const Mark *mark = &part->marks.marks[part->marks.next++];
    part->is_last = part->marks.next == part->marks.count;
    part->start_s = part->end_s;
    part->end_s = part->is_last ? step_end_s : step_start_s + mark->time_s;
    const KernelSums before = part->before;
    part->before = part->sums;
    part->sums = before;
    kernel_at(kernel, mark->node, mark->time_s, &part->sums);
    return mark;
}

void impulse_part_record(ImpulsePart *part, const Linkage *linkage, const JointState *joints)
{
    part->record = (StepRecord){
        .start_s = part->start_s,
        .end_s = part->end_s,
        .joint_s = part->end_s,
        .omega = part->omega,
        .alpha = part->alpha,
        .joints = joints,
        .impulse = part->impulse,
        .approach = part->approach,
        .dissipated = part->sums.dissipated - part->before.dissipated,
        .friction = part->sums.friction - part->before.friction,
    };
    for (size_t i = 0; i < linkage->joint_count; i++) {
        part->impulse[i] = joints[i].force * (part->end_s - part->start_s);
    }
}

void impulse_part_add_place(ImpulsePart *part, const KernelContact *place, bool is_touching,
                            double pushed)
{
    const int joint = place->joint;
    part->impulse[joint] = part->is_known[joint] ? part->impulse[joint] + pushed : pushed;
    const double touching_s = is_touching ? place->state.age_s : INFINITY;
    if (!part->is_known[joint] || touching_s < part->since_s[joint]) {
        part->approach[joint] = place->state.impact_speed;
        part->since_s[joint] = touching_s;
    }
    part->is_known[joint] = true;
}

void impulse_part_add_contacts(ImpulsePart *part, const Kernel *kernel, const Mark *mark,
                               const double *depths, const bool *counts)
{
    size_t touching = 0;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        part->is_known[kernel->contacts[i].joint] = false;
    }
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *place = &kernel->contacts[i];
        if (place->is_rub) {
            continue;
        }
        const bool is_touching = kernel_touches(kernel, mark->node, i);
        const size_t row = place->first_row;
        if (is_touching) {
            part->record.elastic += force_law_energy(&place->law, depths[i]);
            touching++;
        }
        if (counts == NULL || counts[i]) {
            const double pushed =
                hypot(part->sums.impulse[row] - part->before.impulse[row],
                      part->sums.impulse[row + 1] - part->before.impulse[row + 1]);
            impulse_part_add_place(part, place, is_touching, pushed);
        }
    }
    part->most_rows = touching > part->most_rows ? touching : part->most_rows;
}

void impulse_part_finish(ImpulsePart *part)
{
    marks_finish(&part->marks);
    kernel_sums_free(&part->sums);
    kernel_sums_free(&part->before);
    free(part->omega);
    free(part->alpha);
    free(part->impulse);
    free(part->approach);
    free(part->since_s);
    free(part->is_known);
}

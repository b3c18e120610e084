// Says what a part of a step holds of the contacts that were integrated inside it.
#include "ode/impulse.h"

#include "base/zeroed.h"

#include <math.h>
#include <string.h>

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

// Which bodies, joints and places does a step have altogether?
#include "ode/impulse_scope.h"

#include "base/zeroed.h"

static size_t *make_numbers(size_t count)
{
    size_t *numbers = zeroed(count, sizeof *numbers);
    for (size_t i = 0; i < count; i++) {
        numbers[i] = i;
    }
    return numbers;
}

ImpulseScope impulse_scope_whole(const Linkage *linkage, size_t place_count)
{
    return (ImpulseScope){
        .is_whole = true,
        .has_drive = linkage_driven_body(linkage) >= 0,
        .body_count = linkage->body_count,
        .bodies = make_numbers(linkage->body_count),
        .joint_count = linkage->joint_count,
        .joints = make_numbers(linkage->joint_count),
        .place_count = place_count,
        .part.place_count = place_count,
        .part.places = make_numbers(place_count),
    };
}

void impulse_scope_finish(ImpulseScope *scope)
{
    free(scope->bodies);
    free(scope->joints);
    free(scope->part.groups);
    free(scope->part.places);
    *scope = (ImpulseScope){.body_count = 0};
}

KernelPose impulse_scope_pose(const Kernel *kernel, const KernelIslands *islands, size_t place,
                              ImpulseTime at, const KernelSums *sums)
{
    return islands != NULL ? kernel_islands_pose(islands, place, at.since_s, sums)
                           : kernel_pose(kernel, place, at.node, at.since_s, sums);
}

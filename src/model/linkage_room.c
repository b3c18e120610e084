// Makes, copies and frees the arrays of a linkage.
//
// One block for each kind of member, as long as the linkage was made for. Members are plain data:
// a copy of a linkage is a copy of its blocks.
#include "model/linkage.h"

#include "base/zeroed.h"

#include <string.h>

Linkage linkage_create(LinkageRoom room)
{
    return (Linkage){
        .bodies = zeroed(room.bodies, sizeof(Body)),
        .joints = zeroed(room.joints, sizeof(Joint)),
        .springs = zeroed(room.springs, sizeof(Spring)),
        .torsions = zeroed(room.torsions, sizeof(TorsionSpring)),
        .bushings = zeroed(room.bushings, sizeof(Bushing)),
        .loads = zeroed(room.loads, sizeof(Load)),
        .further = zeroed(room.further, sizeof(Driver)),
        .profiles = zeroed(room.profiles, sizeof(Profile)),
    };
}

static void copy_block(void *target, const void *source, size_t count, size_t size)
{
    if (count > 0) {
        memcpy(target, source, count * size);
    }
}

Linkage linkage_copy(const Linkage *linkage)
{
    const LinkageRoom room = {.bodies = linkage->body_count,
                              .joints = linkage->joint_count,
                              .springs = linkage->spring_count,
                              .torsions = linkage->torsion_count,
                              .bushings = linkage->bushing_count,
                              .loads = linkage->load_count,
                              .further = linkage->further_count,
                              .profiles = linkage->profile_count};
    const Linkage made = linkage_create(room);
    copy_block(made.bodies, linkage->bodies, room.bodies, sizeof(Body));
    copy_block(made.joints, linkage->joints, room.joints, sizeof(Joint));
    copy_block(made.springs, linkage->springs, room.springs, sizeof(Spring));
    copy_block(made.torsions, linkage->torsions, room.torsions, sizeof(TorsionSpring));
    copy_block(made.bushings, linkage->bushings, room.bushings, sizeof(Bushing));
    copy_block(made.loads, linkage->loads, room.loads, sizeof(Load));
    copy_block(made.further, linkage->further, room.further, sizeof(Driver));
    copy_block(made.profiles, linkage->profiles, room.profiles, sizeof(Profile));
    Linkage copy = *linkage;
    copy.bodies = made.bodies;
    copy.joints = made.joints;
    copy.springs = made.springs;
    copy.torsions = made.torsions;
    copy.bushings = made.bushings;
    copy.loads = made.loads;
    copy.further = made.further;
    copy.profiles = made.profiles;
    return copy;
}

void linkage_free(Linkage *linkage)
{
    free(linkage->bodies);
    free(linkage->joints);
    free(linkage->springs);
    free(linkage->torsions);
    free(linkage->bushings);
    free(linkage->loads);
    free(linkage->further);
    free(linkage->profiles);
    *linkage = (Linkage){.body_count = 0};
}

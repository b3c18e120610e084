// A planar mechanism put into space, for measurements of growth.
#pragma once

#include "model/space.h"

// All axes along z; with `is_tilted`, of every second joint by 37 degrees towards y.
static inline void lifted(Linkage *linkage, bool is_tilted)
{
    linkage->is_spatial = true;
    space_complete(linkage);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        linkage->joints[i].space.axis =
            is_tilted && i % 2 == 1 ? (Vec3){0.0, 0.6, 0.8} : (Vec3){0.0, 0.0, 1.0};
    }
}

// Where the axis of a round pin is against the centre of its hole, and the directions across it:
// once for the pins of a case and for those of a caller's world.
#pragma once

#include "base/vec3.h"

// From the hole's centre to the point of the pin's axis that is nearest to it: the pin's middle
// less what of it is along the axis, unit.
static inline Vec3 pin_axis_offset(Vec3 hole, Vec3 middle, Vec3 axis)
{
    return vec3_across(vec3_sub(middle, hole), axis);
}

// Two directions across the axis, with which it makes a right-handed frame as the third.
static inline void pin_axis_across(Vec3 axis, Vec3 across[2])
{
    across[0] = vec3_normal_to(axis);
    across[1] = vec3_cross(axis, across[0]);
}

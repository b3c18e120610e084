// Which speeds are large and which are rounding, in a scenario that may start at rest?
//
//     moving = max(|v at the start|, |w| reach, sqrt(2 g reach)),   turning = moving / reach or
//     more
#include "model/scale.h"

SpeedScale scale_speeds(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    SpeedScale scale = {.turning = fabs(linkage->driver.is_present ? linkage->driver.speed : 0.0)};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        scale.reach = fmax(scale.reach, vec2_length(joint->anchor_a));
        scale.reach = fmax(scale.reach, vec2_length(joint->anchor_b));
        scale.reach = fmax(scale.reach, joint->clearance.hole_radius);
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Motion *start = &linkage->bodies[i].start;
        scale.turning = fmax(scale.turning, fabs(start->omega));
        scale.moving = fmax(scale.moving, vec2_length(start->velocity));
    }
    scale.moving = fmax(scale.moving, scale.turning * scale.reach);
    scale.moving = fmax(scale.moving, sqrt(2.0 * fabs(scenario->gravity) * scale.reach));
    scale.moving = scale.moving > 0.0 ? scale.moving : 1.0;
    scale.turning = fmax(scale.turning, scale.reach > 0.0 ? scale.moving / scale.reach : 1.0);
    return scale;
}

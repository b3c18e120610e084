// The friction of an ideal joint, with its defaults: how a pivot resists being turned, and a slider
// being pushed.
#pragma once

#include "model/linkage.h"

// m, the radius at which friction that is given as a torque slides, and that of a bristle's bend
extern const double JOINT_FRICTION_RADIUS;
extern const double JOINT_FRICTION_PRESLIDING;

// Whether there is any.
static inline bool joint_friction_is(const Joint *joint)
{
    const bool has_any = joint->contact.has_friction && joint->contact.friction > 0.0;
    return joint_is_ideal(joint->kind) && (has_any || joint->friction.steady > 0.0);
}

// Whether a joint of a linkage has any; and the first that has, or -1.
int joint_friction_first(const Linkage *linkage);

// m, of a pivot.
static inline double joint_friction_radius(const Joint *joint)
{
    return joint->friction.radius > 0.0 ? joint->friction.radius : JOINT_FRICTION_RADIUS;
}

// 1, static over sliding friction.
static inline double joint_friction_ratio(const Joint *joint)
{
    return joint->friction.ratio > 0.0 ? joint->friction.ratio : 1.0;
}

// m
static inline double joint_friction_presliding(const Joint *joint)
{
    return joint->friction.presliding > 0.0 ? joint->friction.presliding
                                            : JOINT_FRICTION_PRESLIDING;
}

// 1, of the bristle
static inline double joint_friction_damping(const Joint *joint)
{
    return joint->friction.damping > 0.0 ? joint->friction.damping : 1.0;
}

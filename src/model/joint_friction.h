// The friction of joints with its defaults; of an ideal joint how a pivot resists being turned, and
// a slider being pushed.
#pragma once

#include "model/linkage.h"
#include "model/options.h"

// m, the radius at which friction that is given as a torque slides
extern const double JOINT_FRICTION_RADIUS;

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

// m, at which an angle of a pivot counts as a length; 1 of a slider, which has lengths.
static inline double joint_friction_reach(const Joint *joint)
{
    return joint_slides(joint->kind) ? 1.0 : joint_friction_radius(joint);
}

// The friction of an ideal joint over what presses in it, m of a pivot, 1 of a slider; 0 of a
// steady one.
static inline double joint_friction_arm(const Joint *joint)
{
    return joint->contact.has_friction ? joint->contact.friction * joint_friction_reach(joint)
                                       : 0.0;
}

// What a friction is over what presses, as above; of a steady one all of it, N m or N.
static inline double joint_friction_over(const Joint *joint)
{
    return joint->friction.steady > 0.0 ? joint->friction.steady : joint_friction_arm(joint);
}

// A joint's friction with what it takes from the contact that all share.
JointFriction joint_friction_whole(const ContactOptions *contact, const Joint *joint);

// kg, of the two bodies of a joint against each other; 0 where both are held.
double joint_friction_mass(const Linkage *linkage, const Joint *joint);

// Its law of friction, in angles where it turns; without damping, which comes of what presses.
BristlePair joint_friction_pair(const ContactOptions *contact, const Joint *joint);

// 1/kg, 1/(kg m^2): how the two bodies of an ideal joint that slides or turns accelerate against
// each other without any joint; 0 where both are driven.
double joint_friction_mobility(const Linkage *linkage, const Joint *joint);

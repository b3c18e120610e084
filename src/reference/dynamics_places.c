// Where do the bodies of a linkage touch, and how far may each place be from touching before it is
// looked at again?
#include "reference/dynamics_places.h"

#include "model/coordinate.h"
#include "reference/tree.h"
#include "reference/tree_coordinate.h"

#include <math.h>
#include <stdlib.h>

// m: a place that is apart is looked at before its bodies have come so much nearer. Of a stop that
// is no play, but how far the body that touches reaches from where it does; of an angle with one
// stop, rad.
static double flight_of(const Linkage *linkage, const double *reaches, const Touch *touch)
{
    const Joint *joint = &linkage->joints[touch->joint];
    if (joint->limits.kind != LIMIT_NONE) {
        const double half = coordinate_play(joint);
        const double beyond =
            joint->kind == JOINT_PRISMATIC
                ? reaches[joint->body_b == LINKAGE_GROUND ? joint->body_a : joint->body_b]
                : 1.0;
        return isfinite(half) ? half : beyond;
    }
    if (joint->kind != JOINT_STOP) {
        return linkage_radial_clearance(joint);
    }
    const int body = joint->body_b == LINKAGE_GROUND ? joint->body_a : joint->body_b;
    return touch->shape == TOUCH_DISC ? touch->clearance : reaches[body];
}

// m: the lever of an angle, the shorter of how far its bodies reach; 1 of a length.
static double arm_of(const Linkage *linkage, const double *reaches, const Touch *touch)
{
    double arm = INFINITY;
    for (int side = 0; touch->shape == TOUCH_TURN && side < 2; side++) {
        const int body = linkage_end(&linkage->joints[touch->joint], side).body;
        arm = body == LINKAGE_GROUND ? arm : fmin(arm, reaches[body]);
    }
    return touch->shape == TOUCH_TURN ? arm : 1.0;
}

// By how many places the one at the other end of a limited coordinate comes later.
static int find_partner(const Scenario *scenario, const Touch *touches, size_t count, size_t number)
{
    if (scenario->linkage.joints[touches[number].joint].limits.kind == LIMIT_NONE) {
        return 0;
    }
    const bool is_low = number + 1 < count && touches[number + 1].joint == touches[number].joint;
    const bool is_high = number > 0 && touches[number - 1].joint == touches[number].joint;
    return is_low ? 1 : is_high ? -1 : 0;
}

static PlanePlace place_of(const Dynamics *dynamics, const Touch *touch, size_t of_joint)
{
    const Joint *joint = &dynamics->tree.linkage->joints[touch->joint];
    Touch places[TOUCH_CORNERS];
    const bool has_own = tree_own_pairs(joint, touch->joint, places) > 0;
    return (PlanePlace){
        .touch = *touch,
        .pair = has_own ? dynamics->tree.corners[touch->joint] + (int)of_joint : touch->joint,
        .acts_beside = touch->shape == TOUCH_LINE || touch->shape == TOUCH_TEETH ||
                       (touch->law.friction > 0.0 && touch->shape != TOUCH_TURN),
        .end = touch->clearance - touch->sign * tree_coordinate_origin(joint),
    };
}

bool dynamics_places_list(const Scenario *scenario, Dynamics *dynamics, Err *err)
{
    System *system = &dynamics->system;
    Touch *touches;
    if (!touch_list(scenario, &touches, &system->contact_count, err)) {
        return false;
    }
    size_t of_joint = 0; // the number of the place among those of its joint
    for (size_t i = 0; i < system->contact_count; i++) {
        const Touch *touch = &touches[i];
        of_joint = i > 0 && touches[i - 1].joint == touch->joint ? of_joint + 1 : 0;
        system->contacts[i] = (Contact){
            .joint = touch->joint,
            .partner = find_partner(scenario, touches, system->contact_count, i),
            .law = touch->law,
            .clearance = linkage_radial_clearance(&scenario->linkage.joints[touch->joint]),
            .arm = arm_of(&scenario->linkage, dynamics->reach, touch),
            .flight = flight_of(&scenario->linkage, dynamics->reach, touch),
        };
        dynamics->places[i] = place_of(dynamics, touch, of_joint);
    }
    free(touches);
    return true;
}

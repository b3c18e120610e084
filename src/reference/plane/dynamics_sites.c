// Lists where the bodies of a linkage touch, and how far each place may be from touching before it
// is evaluated again.
#include "reference/plane/dynamics.h"

#include "contact/law.h"
#include "model/coordinate.h"

#include <math.h>
#include <stdlib.h>

// What of a cam may go by until its gap is looked at again: its points by two, between which no
// lobe comes and goes, and at most so much in rad.
static const double CAM_POINTS = 2.0;
static const double CAM_TURN = 0.2;

// m, of its reach
static double flight_of_cam(const Profile *profile)
{
    return profile->reach * fmin(CAM_TURN, CAM_POINTS * 2.0 * M_PI / (double)profile->count);
}

// m: a site that is apart is evaluated before its bodies have come so much nearer. Of a stop that
// is no play, but how far the body that touches reaches from where it does; of an angle with one
// stop, rad.
static double flight_of(const Linkage *linkage, const double *reaches, const Touch *touch)
{
    const Joint *joint = &linkage->joints[touch->joint];
    if (joint->limits.kind != LIMIT_NONE) {
        const double half = coordinate_play(joint);
        const double beyond =
            joint_has_position(joint->kind)
                ? reaches[joint->body_b == LINKAGE_GROUND ? joint->body_a : joint->body_b]
                : 1.0;
        return isfinite(half) ? half : beyond;
    }
    if (!joint_has_disc(joint->kind)) {
        return linkage_radial_clearance(joint);
    }
    switch (touch->shape) {
    case TOUCH_CAM:
        return flight_of_cam(touch->cam.profile);
    case TOUCH_DISC:
    case TOUCH_SLOT:
        return touch->clearance;
    case TOUCH_LINE:
    case TOUCH_HOLE: // which is no stop's, nor are ends
    case TOUCH_TURN:
    case TOUCH_TEETH:
    case TOUCH_RACK:
        break;
    }
    return reaches[joint->body_b == LINKAGE_GROUND ? joint->body_a : joint->body_b];
}

// m: the lever of an angle, the shorter of how far its bodies reach; 1 of a length.
static double site_arm(const Linkage *linkage, const double *reaches, const Touch *touch)
{
    double arm = INFINITY;
    for (int side = 0; touch_is_torque(touch) && side < 2; side++) {
        const int body = linkage_end(&linkage->joints[touch->joint], side).body;
        arm = body == LINKAGE_GROUND ? arm : fmin(arm, reaches[body]);
    }
    return touch_is_torque(touch) ? arm : 1.0;
}

// By how many sites the one at the other end of a limited coordinate comes later.
static int find_partner(const Scenario *scenario, const Touch *touches, size_t count, size_t number)
{
    if (scenario->linkage.joints[touches[number].joint].limits.kind == LIMIT_NONE) {
        return 0;
    }
    const bool is_low = number + 1 < count && touches[number + 1].joint == touches[number].joint;
    const bool is_high = number > 0 && touches[number - 1].joint == touches[number].joint;
    return is_low ? 1 : is_high ? -1 : 0;
}

// Whether the force of a site has a moment about the anchors.
static bool acts_beside(const Touch *touch)
{
    switch (touch->shape) {
    case TOUCH_LINE:
    case TOUCH_CAM:
    case TOUCH_SLOT:
    case TOUCH_TEETH:
    case TOUCH_RACK:
        return true;
    case TOUCH_TURN:
        return false;
    case TOUCH_HOLE:
    case TOUCH_DISC:
        break;
    }
    return touch->law.friction > 0.0;
}

static PlaneSite site_of(const Dynamics *dynamics, const Touch *touch, size_t of_joint)
{
    const Joint *joint = &dynamics->tree.linkage->joints[touch->joint];
    Touch sites[TOUCH_CORNERS];
    const bool has_own =
        tree_own_pairs(dynamics->tree.linkage, touch->joint, sites) > 0 && !touch_has_walls(touch);
    return (PlaneSite){
        .touch = *touch,
        .pair = has_own ? dynamics->tree.corners[touch->joint] + (int)of_joint : touch->joint,
        .acts_beside = acts_beside(touch),
        .end = touch->clearance - touch->sign * tree_coordinate_origin(joint),
    };
}

bool dynamics_list_sites(const Scenario *scenario, Dynamics *dynamics, Err *err)
{
    System *system = &dynamics->system;
    Touch *touches;
    if (!touch_list(scenario, &touches, &system->contact_count, err)) {
        return false;
    }
    size_t of_joint = 0; // the number of the site among those of its joint
    for (size_t i = 0; i < system->contact_count; i++) {
        const Touch *touch = &touches[i];
        of_joint = i > 0 && touches[i - 1].joint == touch->joint ? of_joint + 1 : 0;
        system->contacts[i] = (Contact){
            .joint = touch->joint,
            .place = touch->place,
            .partner = find_partner(scenario, touches, system->contact_count, i),
            .law = touch->law,
            .clearance = touch_has_walls(touch)
                             ? touch->clearance
                             : linkage_radial_clearance(&scenario->linkage.joints[touch->joint]),
            .has_walls = touch_has_walls(touch),
            .arm = site_arm(&scenario->linkage, dynamics->reach, touch),
            .flight = flight_of(&scenario->linkage, dynamics->reach, touch),
        };
        dynamics->sites[i] = site_of(dynamics, touch, of_joint);
    }
    free(touches);
    return true;
}

// How deep may a pin be in its wall, or a block in its guide, before no contact law means anything
// any more?
#include "contact/law.h"

#include <math.h>

double law_depth_max(const ForceLaw *law, double radius)
{
    const double share = 0.1;
    return fmin(share * radius, force_law_depth_limit(law));
}

double law_touching_radius(const Joint *joint)
{
    const Stop *stop = &joint->stop;
    const double other = stop->is_disc && stop->radius_a > 0.0 ? stop->radius_a : INFINITY;
    switch (joint->kind) {
    case JOINT_GUIDE:
        return 0.5 * fmin(joint->guide.height, joint->guide.opening);
    case JOINT_GEAR:
        return fmin(fabs(joint->gear.radius_a), fabs(joint->gear.radius_b));
    case JOINT_REVOLUTE:
    case JOINT_PRISMATIC:
        return INFINITY; // at its limits
    case JOINT_STOP:
        return fmin(stop->radius_b > 0.0 ? stop->radius_b : INFINITY, other);
    default:
        return joint->clearance.pin_radius;
    }
}

bool law_check_depth(const ForceLaw *law, const Joint *joint, double depth, double share, Err *err)
{
    const double allowed = law_depth_max(law, law_touching_radius(joint));
    if (depth <= share * allowed) {
        return true;
    }
    static const char *const WORDS[][2] = {
        [JOINT_CLEARANCE] = {"pin", "the wall of its hole"},
        [JOINT_GUIDE] = {"block", "its guide"},
        [JOINT_STOP] = {"second body", "what stops it"},
        [JOINT_GEAR] = {"second gear", "the first one"},
    };
    return err_set(
        err, ERR_SOLVER, "the %s of %s is %.4g mm inside %s; no contact law holds beyond %.4g mm",
        WORDS[joint->kind][0], joint->name, 1e3 * depth, WORDS[joint->kind][1], 1e3 * allowed);
}

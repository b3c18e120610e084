// How deep may a pin be in its wall, or a block in its guide, before no contact law means anything
// any more?
#include "contact/law.h"

#include <math.h>

double law_touching_radius(const Joint *joint)
{
    const Stop *stop = &joint->stop;
    const double other = stop->cam > 0                           ? stop->hump
                         : stop->is_disc && stop->radius_a > 0.0 ? stop->radius_a
                                                                 : INFINITY;
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_GUIDES:
        return 0.5 * fmin(joint->guide.height, joint->guide.opening);
    case JOINT_TOUCHES_TEETH:
        return fmin(fabs(joint->gear.radius_a), fabs(joint->gear.radius_b));
    case JOINT_TOUCHES_NOTHING:
        return INFINITY; // at its limits
    case JOINT_TOUCHES_DISC:
        return fmin(stop->radius_b > 0.0 ? stop->radius_b : INFINITY, other);
    case JOINT_TOUCHES_HOLE:
        break;
    }
    return joint->clearance.pin_radius;
}

// How deep what touches is where all of it is inside the other body, m. What meets a line or a disc
// from outside may sink in as far as its stiffness says.
static double whole_part(const Joint *joint)
{
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        return joint->clearance.is_pin_assumed ? INFINITY : 2.0 * law_touching_radius(joint);
    case JOINT_TOUCHES_GUIDES:
    case JOINT_TOUCHES_TEETH:
        return 2.0 * law_touching_radius(joint);
    case JOINT_TOUCHES_DISC:
        return joint->stop.slot > 0.0 ? 2.0 * law_touching_radius(joint) : INFINITY;
    case JOINT_TOUCHES_NOTHING:
        break;
    }
    return INFINITY;
}

static double law_range(const ForceLaw *law)
{
    return fmin(law->depth_most, force_law_depth_limit(law));
}

double law_depth_max(const ForceLaw *law, const Joint *joint)
{
    return fmin(law_range(law), whole_part(joint));
}

// What a joint's body b is inside which part of body a.
typedef struct Parts {
    const char *inner;
    const char *outer;
} Parts;

static Parts parts_of(const Joint *joint)
{
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        return (Parts){"pin", "the wall of its hole"};
    case JOINT_TOUCHES_GUIDES:
        return (Parts){"block", "its guide"};
    case JOINT_TOUCHES_TEETH:
        return joint_has_rack(joint->kind) ? (Parts){"pinion", "its rack"}
                                           : (Parts){"second gear", "the first one"};
    case JOINT_TOUCHES_DISC:
        if (joint->stop.slot > 0.0) {
            return (Parts){"pin", "the wall of its slot"};
        }
        break;
    case JOINT_TOUCHES_NOTHING:
        break;
    }
    return (Parts){"second body", "what stops it"};
}

bool law_check_depth(const ForceLaw *law, const Joint *joint, double depth, double share, Err *err)
{
    const double allowed = law_depth_max(law, joint);
    if (depth <= share * allowed && depth < INFINITY) {
        return true;
    }
    const Parts parts = parts_of(joint);
    if (isinf(allowed)) {
        return err_set(err, ERR_SOLVER, "how deep the %s of %s is inside %s is no number",
                       parts.inner, joint->name, parts.outer);
    }
    if (allowed < law_range(law)) {
        return err_set(err, ERR_SOLVER,
                       "the %s of %s is %.4g mm inside %s, which is all of it: its size is %.4g mm",
                       parts.inner, joint->name, 1e3 * depth, parts.outer, 1e3 * allowed);
    }
    return err_set(err, ERR_SOLVER,
                   "the %s of %s is %.4g mm inside %s; no contact law holds beyond %.4g mm",
                   parts.inner, joint->name, 1e3 * depth, parts.outer, 1e3 * allowed);
}

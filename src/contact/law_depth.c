// How deep may a pin be in its wall before no contact law means anything any more?
#include "contact/law.h"

#include <math.h>

double law_depth_max(const ForceLaw *law, double pin_radius)
{
    const double share = 0.1;
    return fmin(share * pin_radius, force_law_depth_limit(law));
}

bool law_check_depth(const ForceLaw *law, const Joint *joint, double depth, double share, Err *err)
{
    const double allowed = law_depth_max(law, joint->clearance.pin_radius);
    return depth <= share * allowed ||
           err_set(err, ERR_SOLVER,
                   "the pin of %s is %.4g mm inside the wall of its hole; no contact law holds "
                   "beyond %.4g mm",
                   joint->name, 1e3 * depth, 1e3 * allowed);
}

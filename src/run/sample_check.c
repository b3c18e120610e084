// Is the motion determined where a sample is taken?
#include "run/sample_check.h"

#include <math.h>

bool run_check_sample(const Linkage *linkage, const SolverPart *part, const Sample *sample,
                      Err *err)
{
    const size_t count = solver_body_count(part, linkage);
    for (size_t k = 0; k < count; k++) {
        const size_t i = solver_body(part, k);
        if (!isfinite(sample->bodies[i].omega)) {
            char where[LINKAGE_INSTANT_SIZE];
            linkage_describe_instant(linkage, sample->time_s, where);
            return err_set(err, ERR_SOLVER,
                           "%s: the motion of %s is not determined: the ideal joints stand at a "
                           "change point, or are redundant; give one of them play",
                           where, linkage->bodies[i].name);
        }
    }
    return true;
}

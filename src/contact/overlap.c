// Finds the mean force of a contact in the step in which it begins or ends.
//
// Where positions stand at mid-step the force there is not the mean of such a step: at a way v t
// into the wall the mean of a step of h in which the contact overlaps for T is W(v T) / (v h), W
// the elastic energy at a depth. The depth of the row is the one of that mean force, and a damper
// acts for its share T / h of the step. Without this the speed after the onset is wrong by up to
// (omega h)^2 / 8 times what the damping multiplies the force by.
#include "contact/overlap.h"

#include <math.h>

// From the depths at mid-step and at the step's ends, and the way between these.
static Overlap overlap_by_ends(const ForceLaw *law, double middle, double start, double end,
                               double way)
{
    if (start >= 0.0 && end >= 0.0) {
        return (Overlap){.depth = middle, .share = 1.0};
    }
    const double deepest = fmax(start, end);
    if (!(deepest > 0.0)) {
        return (Overlap){.depth = 0.0};
    }
    const double mean = force_law_energy(law, deepest) / way;
    return (Overlap){.depth = force_law_penetration(law, mean), .share = deepest / way};
}

Overlap overlap_find(const ForceLaw *law, double gap, double closing, double step_s)
{
    const double start = -gap - closing * (0.5 * step_s);
    const double end = start + closing * step_s;
    Overlap found = overlap_by_ends(law, -gap, start, end, fabs(closing) * step_s);
    found.onset = start < 0.0 && end > 0.0 ? -start / closing : 0.0;
    return found;
}

Overlap overlap_between(const ForceLaw *law, double gap, const double gaps[2], double step_s)
{
    Overlap found = overlap_by_ends(law, -gap, -gaps[0], -gaps[1], fabs(gaps[1] - gaps[0]));
    found.onset = gaps[0] > 0.0 && gaps[1] < 0.0 ? step_s * gaps[0] / (gaps[0] - gaps[1]) : 0.0;
    return found;
}

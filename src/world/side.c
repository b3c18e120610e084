// Does a side touch, since which speed, and what did it do?
//
// Where a contact begins or ends in a step whose positions stand at mid-step, the force at the
// middle is not the mean of the step: at a way v t into the wall the mean of a step of h in which
// the side is inside for T is W(v T) / (v h), W the elastic energy at a depth. The depth of the row
// is the one of that mean force, and a damper acts for its share T / h of the step. Without this
// the speed after the onset is wrong by up to (omega h)^2 / 8 times what the damping multiplies the
// force by.
//
// The speed of the onset is that at the instant of touching, between two steps: the last known
// rate, taken on or back by its change over the step before. Taken at the first step that overlaps
// it would be late by an accidental part of a step.
#include "world/side.h"

#include <math.h>

// How much of a step a side is overlapped in.
typedef struct Overlap {
    double depth; // that gives the mean force of the step; 0 where it does not touch
    double share; // of the step
    double onset; // s, from the step's start to where it begins to touch, where that is in the step
} Overlap;

static Overlap find_overlap(const Side *side, double gap, double earlier, double step)
{
    if (!(earlier > 0.0)) {
        return (Overlap){.depth = fmax(-gap, 0.0), .share = 1.0};
    }
    const double start = -gap - side->closing * earlier;
    const double end = start + side->closing * step;
    if (start >= 0.0 && end >= 0.0) {
        return (Overlap){.depth = -gap, .share = 1.0};
    }
    const double deepest = fmax(start, end);
    if (!(deepest > 0.0)) {
        return (Overlap){.depth = 0.0};
    }
    const double way = fabs(side->closing) * step;
    const double mean = force_law_energy(&side->law, deepest) / way;
    return (Overlap){
        .depth = force_law_penetration(&side->law, mean),
        .share = deepest / way,
        .onset = side->closing > 0.0 ? -start / side->closing : 0.0,
    };
}

void side_begin(Side *side, double closing)
{
    side->impact_speed = fmax(closing, 0.0);
    side->impacts++;
    side->mobility = 0.0;
    side->has_series = false;
    side->since = 0.0;
    side->forces[1] = side->law.viscous * side->impact_speed;
    side->depths[1] = 0.0;
}

void side_find(Side *side, double position, double rate, double earlier, double step)
{
    const double gap = side_gap(side, position);
    const bool was_touching = side->is_touching;
    side->closing = -side->sign * rate;
    const Overlap overlap = find_overlap(side, gap, earlier, step);
    side->is_touching = overlap.depth > 0.0;
    side->depth = overlap.depth;
    side->share = overlap.share;
    side->inside = fmax(-gap, 0.0);
    if (side->is_touching && !was_touching) {
        const double change =
            side->last_step > 0.0 ? (side->closing - side->last_closing) / side->last_step : 0.0;
        const double late = earlier > 0.0 ? overlap.onset : -side->depth / side->closing;
        side_begin(side, side->closing + (side->closing > 0.0 ? change * late : 0.0));
        side->since = earlier > 0.0 ? earlier - late : -late;
    }
    side->last_closing = side->closing;
    side->last_step = side->is_touching ? 0.0 : step;
}

MapContact side_contact(const Side *side, double step)
{
    const double damping = force_law_damping(&side->law, side->depth, side->impact_speed);
    return (MapContact){
        .stiffness = force_law_secant(&side->law, side->depth),
        .damping = damping - side->law.viscous * (1.0 - side->share),
        .step = step,
        .depth = side->depth,
        .closing = side->closing,
    };
}

bool side_is_stable(const Side *side, double limit, double mobility, double step)
{
    return sqrt(force_law_tangent(&side->law, side->depth) * mobility) * step < limit;
}

// The top of the parabola through three values, the middle one `before` behind the first and
// `after` ahead of the last; the largest of the three where it has none between them.
static double top(const double values[3], double before, double after)
{
    const double largest = fmax(values[0], fmax(values[1], values[2]));
    if (!(before > 0.0)) {
        return largest;
    }
    const double rise = (values[1] - values[0]) / before;
    const double fall = (values[2] - values[1]) / after;
    const double bend = (fall - rise) / (before + after);
    const double slope = fall - bend * after;
    const double at = bend < 0.0 ? -0.5 * slope / bend : -before;
    return at > -before && at < after ? values[1] - 0.25 * slope * slope / bend : largest;
}

void side_note_tops(Side *side, double force, double ahead)
{
    side->force_max = fmax(side->force_max, force);
    side->depth_max = fmax(side->depth_max, side->inside);
    if (side->has_series) {
        const double forces[] = {side->forces[0], side->forces[1], force};
        const double depths[] = {side->depths[0], side->depths[1], side->inside};
        side->force_max = fmax(side->force_max, top(forces, side->since, ahead));
        side->depth_max = fmax(side->depth_max, top(depths, side->since, ahead));
        side->since = ahead;
    } else {
        side->has_series = true;
        side->since += ahead;
    }
    side->forces[0] = side->forces[1];
    side->forces[1] = force;
    side->depths[0] = side->depths[1];
    side->depths[1] = side->inside;
}

void side_book(Side *side, double force, double rate_before, double rate_after, double step)
{
    if (side->is_touching && side->share < 1.0) {
        side->force_max = fmax(side->force_max, force);
        side->depth_max = fmax(side->depth_max, side->inside);
        side->since += step;
    } else if (side->is_touching) {
        side_note_tops(side, force, side->has_series ? step : 0.0);
    }
    side->force = force;
    side->impulse += force * step;
    side->work += side->sign * force * step * 0.5 * (rate_before + rate_after);
}

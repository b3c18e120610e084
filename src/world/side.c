// Keeps whether a side touches, since which speed, and what it did.
//
// In a step in which a contact begins or ends its row gets the mean force of the part that overlaps
// (contact/overlap.c).
//
// The speed of the onset is that at the instant of touching, between two steps: the last known
// rate, taken on or back by its change over the step before. Taken at the first step that overlaps
// it would be late by an accidental part of a step.
#include "world/side.h"

#include <math.h>

// A depth beyond what the law holds for has no mean force. It still touches, and the step then
// fails (world/step.c): a comparison with a depth that is no number would let it pass.
static Overlap find_overlap(const Side *side, const SideMotion *motion, double step)
{
    if (!(motion->earlier > 0.0)) {
        return (Overlap){.depth = fmax(-motion->gap, 0.0), .share = 1.0};
    }
    Overlap found = overlap_between(&side->law, motion->gap, motion->gaps, step);
    if (isnan(found.depth)) {
        found.depth = -fmin(motion->gaps[0], motion->gaps[1]);
    }
    return found;
}

void side_begin(Side *side, double closing)
{
    side->state = contact_state_begun(fmax(closing, 0.0));
    side->impacts++;
    side->mobility = 0.0;
    contact_peaks_begin(&side->peaks, force_law_viscous(&side->law, 0.0) * side->state.impact_speed,
                        0.0);
}

void side_find(Side *side, const SideMotion *motion, double step)
{
    const bool was_touching = side->state.is_touching;
    const double start = motion->start_closing;
    const double earlier = motion->earlier;
    side->closing = motion->closing;
    const Overlap overlap = find_overlap(side, motion, step);
    side->state.is_touching = overlap.depth > 0.0;
    side->begins = side->state.is_touching && !was_touching;
    side->age = was_touching ? side->age + step : 0.0;
    side->depth = overlap.depth;
    side->share = overlap.share;
    side->inside = fmax(-motion->gap, 0.0);
    if (side->state.is_touching && was_touching) {
        side->state.age_s = side->age;
        contact_state_follow(&side->state, side->closing, side->law.resting_speed);
    }
    if (side->state.is_touching && !was_touching) {
        const double change =
            side->last_step > 0.0 ? (start - side->last_closing) / side->last_step : 0.0;
        const double late = earlier > 0.0 ? overlap.onset : -side->depth / start;
        side_begin(side, start + (start > 0.0 ? change * late : 0.0));
        side->peaks.since = earlier > 0.0 ? earlier - late : -late;
    }
    side->last_closing = start;
    side->last_step = side->state.is_touching ? 0.0 : step;
}

MapContact side_contact(const Side *side, double step)
{
    const LawRow row = {
        .depth = side->depth,
        .closing = side->closing,
        .impact_speed = side->state.damping_speed,
        .share = side->share,
    };
    return law_row_contact(&side->law, &row, step);
}

bool side_is_stable(const Side *side, const Map *map, double mobility, double step)
{
    return law_row_is_stable(map, force_law_tangent(&side->law, side->depth) * mobility, step);
}

// Notes what is the largest now.
static void keep_largest(Side *side)
{
    side->force_max = fmax(side->force_max, side->peaks.force);
    side->depth_max = fmax(side->depth_max, side->peaks.depth);
}

void side_note(Side *side, double force)
{
    contact_peaks_begin(&side->peaks, force, 0.0);
    side->peaks.force = force;
    side->peaks.depth = side->inside;
    keep_largest(side);
}

void side_book(Side *side, double force, double rate_before, double rate_after, double step)
{
    if (side->state.is_touching) {
        contact_peaks_note_step(&side->peaks, force, side->inside, side->share, step);
        keep_largest(side);
    }
    side->force = force;
    side->impulse += force * step;
    side->work += side->sign * force * step * 0.5 * (rate_before + rate_after);
}

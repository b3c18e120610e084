// Finds the largest force and depth of a contact between the steps that know them.
//
// They are taken to be largest on the parabola through three steps, of which the first may be the
// onset. What a step has that overlaps in a part of it alone is no value at its middle, and no
// point of a parabola.
#include "kernel/contact_peaks.h"

#include <math.h>

// A parabola that is nowhere below 0 at three equal distances is between them at most an eighth
// above the largest of the three. At other distances it is not let above that: beside a short one,
// or a long one after a flat stretch, its top could be at any height.
static const double HIGHEST = 1.125;

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
    return at > -before && at < after
               ? fmin(values[1] - 0.25 * slope * slope / bend, HIGHEST * largest)
               : largest;
}

void contact_peaks_begin(ContactPeaks *peaks, double force, double since)
{
    peaks->has_series = false;
    peaks->since = since;
    peaks->forces[1] = force;
    peaks->depths[1] = 0.0;
}

void contact_peaks_note(ContactPeaks *peaks, double force, double depth, double ahead)
{
    peaks->force = force;
    peaks->depth = depth;
    if (peaks->has_series) {
        const double forces[] = {peaks->forces[0], peaks->forces[1], force};
        const double depths[] = {peaks->depths[0], peaks->depths[1], depth};
        peaks->force = fmax(force, top(forces, peaks->since, ahead));
        peaks->depth = fmax(depth, top(depths, peaks->since, ahead));
        peaks->since = ahead;
    } else {
        peaks->has_series = true;
        peaks->since += ahead;
    }
    peaks->forces[0] = peaks->forces[1];
    peaks->forces[1] = force;
    peaks->depths[0] = peaks->depths[1];
    peaks->depths[1] = depth;
}

void contact_peaks_note_step(ContactPeaks *peaks, double force, double depth, double share,
                             double step_s)
{
    if (share < 1.0) {
        peaks->force = force;
        peaks->depth = depth;
        peaks->since += step_s;
    } else {
        contact_peaks_note(peaks, force, depth, peaks->has_series ? step_s : 0.0);
    }
}

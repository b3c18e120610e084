// How large are force and depth of a contact between the steps that know them?
//
// They are taken to be largest on the parabola through three steps, of which the first may be the
// onset. What a step has that overlaps in a part of it alone is no value at its middle, and no
// point of a parabola.
#include "contact/tops.h"

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

void tops_begin(Tops *tops, double force, double since)
{
    tops->has_series = false;
    tops->since = since;
    tops->forces[1] = force;
    tops->depths[1] = 0.0;
}

void tops_note(Tops *tops, double force, double depth, double ahead)
{
    tops->force = force;
    tops->depth = depth;
    if (tops->has_series) {
        const double forces[] = {tops->forces[0], tops->forces[1], force};
        const double depths[] = {tops->depths[0], tops->depths[1], depth};
        tops->force = fmax(force, top(forces, tops->since, ahead));
        tops->depth = fmax(depth, top(depths, tops->since, ahead));
        tops->since = ahead;
    } else {
        tops->has_series = true;
        tops->since += ahead;
    }
    tops->forces[0] = tops->forces[1];
    tops->forces[1] = force;
    tops->depths[0] = tops->depths[1];
    tops->depths[1] = depth;
}

void tops_note_step(Tops *tops, double force, double depth, double share, double step_s)
{
    if (share < 1.0) {
        tops->force = force;
        tops->depth = depth;
        tops->since += step_s;
    } else {
        tops_note(tops, force, depth, tops->has_series ? step_s : 0.0);
    }
}

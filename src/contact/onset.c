// Finds how fast bodies came to touch that overlap for the first time.
//
// With gaps g0, g1 of the two steps before and g now, v = (g0 - g) / h is the mean speed of the
// last step and stands in its middle, a = v - (g1 - g0) / h its change in a step; the crossing is d
// / v ahead of now, so that the speed there is v + a (1/2 - d / (v h)).
#include "contact/onset.h"

double onset_speed(const Onset *onset, double closing, double gap, double depth, double step_s)
{
    if (onset->known == 0) {
        return closing;
    }
    const double mean = (onset->gaps[0] - gap) / step_s;
    if (onset->known == 1 || !(mean > 0.0)) {
        return mean;
    }
    const double change = mean - (onset->gaps[1] - onset->gaps[0]) / step_s;
    return mean + change * (0.5 - depth / (mean * step_s));
}

void onset_note(Onset *onset, bool is_touching, double gap)
{
    onset->known = is_touching ? 0 : onset->known + (onset->known < 2 ? 1 : 0);
    onset->gaps[1] = onset->gaps[0];
    onset->gaps[0] = gap;
}

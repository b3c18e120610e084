// Finds which way a four-bar can turn, and where it is stuck.
//
// Grashof: with s the shortest and l the longest of the four lengths, p and q the others, some link
// turns fully if and only if s + l < p + q; which one depends on which link is the shortest.
// Coupler b and follower c meet when the diagonal d from crank pin to follower pivot satisfies
//     |b - c| <= d <= b + c,   d^2 = a^2 + g^2 - 2 a g cos(theta).
#include "model/fourbar.h"

#include <math.h>

const char *const FOURBAR_GRASHOF_NAMES[] = {
    "crank-rocker",  "double-crank",  "rocker-crank",
    "double-rocker", "triple-rocker", "change-point",
};

static const double EQUAL = 1e-12; // relative: lengths are given to far fewer digits

GrashofClass fourbar_grashof(const FourBar *fourbar)
{
    const double lengths[] = {fourbar->ground.nominal, fourbar->crank.nominal,
                              fourbar->coupler.nominal, fourbar->follower.nominal};
    double sum = 0.0;
    double longest = 0.0;
    int shortest = 0;
    for (int i = 0; i < 4; i++) {
        sum += lengths[i];
        longest = fmax(longest, lengths[i]);
        shortest = lengths[i] < lengths[shortest] ? i : shortest;
    }
    const double excess = 2.0 * (lengths[shortest] + longest) - sum;
    if (fabs(excess) <= EQUAL * sum) {
        return GRASHOF_CHANGE_POINT;
    }
    if (excess > 0.0) {
        return GRASHOF_TRIPLE_ROCKER;
    }
    static const GrashofClass by_shortest[] = {GRASHOF_DOUBLE_CRANK, GRASHOF_CRANK_ROCKER,
                                               GRASHOF_DOUBLE_ROCKER, GRASHOF_ROCKER_CRANK};
    return by_shortest[shortest];
}

bool fourbar_crank_turns(const FourBar *fourbar)
{
    double shortest;
    double longest;
    fourbar_diagonal_range(fourbar, &shortest, &longest);
    return fabs(fourbar->ground.nominal - fourbar->crank.nominal) > shortest &&
           fourbar->ground.nominal + fourbar->crank.nominal < longest;
}

void fourbar_diagonal_range(const FourBar *fourbar, double *shortest, double *longest)
{
    *shortest = fabs(fourbar->coupler.nominal - fourbar->follower.nominal);
    *longest = fourbar->coupler.nominal + fourbar->follower.nominal;
}

double fourbar_diagonal(const FourBar *fourbar, double crank_angle)
{
    const double a = fourbar->crank.nominal;
    const double g = fourbar->ground.nominal;
    return hypot(g - a * cos(crank_angle), a * sin(crank_angle));
}

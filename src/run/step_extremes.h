// The extremes of signals inside a step, from a solver's states there.
#pragma once

#include "run/looker.h"

// Looks in a step for maxima and minima of the signals that come near the run's extremes, down to
// rounding, one by one; of many signals some are, and the others are seen at the looks that these
// take. `before` is the start of the step, the looks the ends of its parts, LOOK_PARTS_MAX at most.
// Those at maxima are put in between; returns how many looks there are then.
int look_for_extremes(Looker *looker, const Look *before, int parts, Look looks[LOOK_MAX]);

// The same. Where the solver can sketch the step, only at maxima that are likely to be beyond the
// run's extremes; where so many signals of a smooth step may have one that all are found together
// for less, together: the looker then has their peaks.
int look_into_step(Looker *looker, const Look *before, int parts, bool is_smooth,
                   Look looks[LOOK_MAX]);

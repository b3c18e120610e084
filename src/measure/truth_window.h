// Up to when is a truth sure enough?
#pragma once

#include "measure/truth.h"

typedef struct TruthWindow {
    double until_s;     // the end of the run, the truth's horizon, or before it
    double uncertainty; // 1, of the truth up to there
} TruthWindow;

// The longest window from the start in which the uncertainty of the truth is at most `most`. It is
// empty, until_s being 0, where the truth is nowhere that sure. Another run of the reference is
// made only where the truth is not that sure up to its horizon.
TruthWindow truth_window_find(const Scenario *scenario, const Truth *truth, double most,
                              RunWatch watch);

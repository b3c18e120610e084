// The order with which the errors of one scheme have been seen to fall in a search.
#pragma once

#include "commands/tune/tune.h"

typedef struct TuneTrend {
    bool is_known;
    double order;  // error ~ step^order
    double spread; // 1: by how much the two orders differ that it is taken from
    bool is_even;  // whether a third order before them agrees as well
} TuneTrend;

// Of the finest trials of a scheme.
TuneTrend tune_trend_of(const Tune *tune, size_t scheme);

// How many settings further than one with an error the target can be met at the earliest, if the
// errors go on as they fell.
int tune_trend_ahead(const Tune *tune, TuneTrend trend, double error);

// Whether the setting before one with an error can meet the target.
bool tune_trend_may_precede(const Tune *tune, TuneTrend trend, double error);

// Whether the errors of plain steps fall so evenly that the setting behind one that meets the target
// does, too. Of other stepping, whose errors are small, chance has its share in them.
bool tune_trend_confirms(const Tune *tune, size_t scheme);

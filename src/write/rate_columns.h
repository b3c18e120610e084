// The columns of a series that hold the rates by which motions are compared (model/distance.h).
#pragma once

#include "model/distance.h"

enum { RATE_COLUMNS_MOST = 3, RATE_COLUMN_SIZE = LINKAGE_NAME_SIZE + 32 };

// Writes the names of a rate's columns, in the order of its components: x, y, z of a vector.
// Returns how many there are.
int rate_columns(const Linkage *linkage, const DistanceRate *rate,
                 char names[RATE_COLUMNS_MOST][RATE_COLUMN_SIZE]);

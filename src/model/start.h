// The start of a linkage as plain numbers, which a file or another process can keep: all of it that
// a run that is continued changes (model/state.h).
#pragma once

#include "model/linkage.h"

// How many numbers there are of a linkage.
size_t start_number_count(const Linkage *linkage);

// Writes them, all finite.
void start_numbers(const Linkage *linkage, double *numbers);

// Makes them the start of a linkage of as many bodies and joints of the same kinds.
void start_set_numbers(const double *numbers, Linkage *linkage);

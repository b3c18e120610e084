// Fits of ISO 286 as drawings have them: the limits of the hole `30 H7` and of the shaft `30 g6`.
#pragma once

#include "casefile/quantity.h"

// The limits of a size, mm.
typedef struct FitLimits {
    double low;
    double high;
} FitLimits;

// Whether a text is written as a size with one or two tolerance classes and not as a length:
// `30 H7`, `30 mm g6`, `30 H7/g6`.
bool fit_is(const char *text);

// The limits of a hole (capital letters) or of a shaft, of the class that the text has for it.
// Sizes are up to 500 mm, grades IT5 to IT12. Fails on a size, letter or grade that is not in the
// table, and where the text has no class of that kind.
bool fit_read(const char *text, bool is_hole, FitLimits *limits, Complaint *complaint);

// Whether the text has the class of both, as a drawing of the assembly does.
bool fit_is_of_both(const char *text);

// Whether the step under way is too long for what happens in it, and why.
#pragma once

#include "world/play.h"

void coarse_begin(JpWorld *world);

// Notes a reason; the first one stays.
__attribute__((format(printf, 2, 3))) void coarse_note(JpWorld *world, const char *format, ...);

// The status of a step that was made: JP_COARSE with its reason, or JP_OK.
JpStatus coarse_end(JpWorld *world, JpError *error);

// The lines of a run's text about what pushes the mechanism beside its joints.
#pragma once

#include "base/text.h"
#include "model/linkage.h"

// Appends them, no wider than so many columns; nothing where there is none.
void run_loads_write(const Linkage *linkage, size_t width, Text *text);

// The lines of a run's text about what pushes the mechanism beside its joints.
#pragma once

#include "base/text.h"
#include "model/linkage.h"

// Appends them, no wider than so many columns; nothing where there is none.
void run_loads_write(const Linkage *linkage, size_t width, Text *text);

// Appends a sinusoid about its mean, in the unit given, so many of which make an SI unit.
void run_loads_write_wave(double mean, const Wave *wave, double scale, const char *unit,
                          Text *text);

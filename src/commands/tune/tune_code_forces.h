// Springs, dampers and a torque as members of a scenario in C.
#pragma once

#include "base/text.h"
#include "model/linkage.h"

// Appends them as designated initialisers; nothing where there are none.
void tune_code_forces(const Linkage *linkage, Text *text);

// Appends a table over time that is the member of that name; the unit is that of its values.
void tune_code_table(const char *name, const TimeTable *table, const char *unit, Text *text);

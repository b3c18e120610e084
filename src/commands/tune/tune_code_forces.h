// Springs, dampers, a torque, and what limits a joint's coordinate, as members of a scenario in C.
#pragma once

#include "base/text.h"
#include "model/linkage.h"

// Appends them as designated initialisers; nothing where there are none.
void tune_code_forces(const Linkage *linkage, Text *text);

// Appends a table over time that is the member of that name; the unit is that of its values.
void tune_code_table(const char *name, const TimeTable *table, const char *unit, Text *text);

// Appends what limits a joint's coordinate, and what a pair of gears is made of; nothing where
// there are no limits.
void tune_code_limits(const Joint *joint, Text *text);

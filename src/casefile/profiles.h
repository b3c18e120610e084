// Curves over an angle that a case gives by points: profiles of cams, transmission errors of gears.
#pragma once

#include "casefile/target.h"

// How many there are.
size_t profiles_count(const Entries *entries);

// Gives every joint that has one its own, before values are stored.
void profiles_prepare(const Entries *entries, Scenario *scenario);

// Stores the points of one, whose number among the linkage's the field is.
bool profiles_store(const Target *target, Linkage *linkage);

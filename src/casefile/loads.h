// Loads as a case writes them: a constant, points in the case, or points in a CSV file beside it.
#pragma once

#include "casefile/target.h"

// Notes what the keys that are given make of each load, before any value is stored.
void loads_prepare(const Entries *entries, Linkage *linkage);

// Stores the force or torque of a load: `1.2 kN`, `[[0 deg, 0 N], [90 deg, 1.2 kN]]`, or the name
// of a CSV file, whose head gives the units: `crank angle [deg], force [kN]`.
bool loads_store_value(const Target *target, const Linkage *linkage, Load *load);

// Stores after what a load repeats: a time, an angle or a length, as it is over.
bool loads_store_period(const Target *target, const Linkage *linkage, Load *load);

// Lets loads repeat as they do by themselves, once all values are there: over the crank's angle in
// every turn. Fails with ERR_CASE where the points do not fit into a period, or loads and joints do
// not go together.
bool loads_complete(const Entries *entries, Linkage *linkage, Err *err);

// Whether a key of a load says how it is.
bool loads_apply(const SchemaRow *row, const Linkage *linkage, const Load *load);

// What its points are over.
Dimension loads_dimension(const Linkage *linkage, const Load *load);

// A torque, a speed or an angle over time, as a case writes it.
#pragma once

#include "casefile/entries.h"

// Reads one value, a sinusoid, or a list of times and values `[[0 s, 1 N m], [10 ms, 0 N m]]`. A
// wrong value is an error with its place and what would be allowed.
bool over_time_store(const Entries *entries, const Entry *entry, TimeTable *table, Err *err);

// The same for the speed of a drive: the same value at all times is a constant speed.
bool over_time_store_speed(const Entries *entries, const Entry *entry, Driver *driver, Err *err);

// The angles of a drive: two points at least, the first of angle 0, or a sinusoid that begins
// there. A soft drive may have one angle to hold, and begin with any.
bool over_time_store_angles(const Entries *entries, const Entry *entry, Driver *driver, Err *err);

// A torque or a speed, constant or over time, as a case writes it.
#pragma once

#include "casefile/entries.h"

// Reads one value, or a list of times and values `[[0 s, 1 N m], [10 ms, 0 N m]]`, into points. A
// wrong value is an error with its place and what would be allowed.
bool over_time_store(const Entry *entry, TimeTable *table, Err *err);

// The same for the speed of a drive: the same value at all times is a constant speed.
bool over_time_store_speed(const Entry *entry, Driver *driver, Err *err);

// Lets a speed over time repeat, once speed and period are read: a last point that is the first of
// the next period is left out. Fails with ERR_CASE where the points do not fit into the period, or
// the drive does not turn by whole turns in it.
bool over_time_repeat(const Entries *entries, Driver *driver, Err *err);

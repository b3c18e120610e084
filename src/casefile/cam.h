// What a case says about cams: what rides on them.
#pragma once

#include "casefile/target.h"

// Says how far cams reach, and makes a flat of what a normal is beside a profile, once all values
// are stored.
void cam_complete(const Entries *entries, Linkage *linkage);

// Checks that what rides on a joint's profile meets it at one point.
bool cam_check(const Entries *entries, size_t index, const Linkage *linkage, Err *err);

// What a case says about cams: their profiles, and what rides on them.
#pragma once

#include "casefile/target.h"

// How many joints have a profile.
size_t cam_count(const Entries *entries);

// Gives every joint that has a profile its own, before values are stored.
void cam_prepare(const Entries *entries, Linkage *linkage);

// Stores the points of a profile.
bool cam_store(const Target *target, Linkage *linkage, Stop *stop);

// Makes a flat of what a normal is beside a profile, once all values are stored.
void cam_complete(const Entries *entries, Linkage *linkage);

// Checks that what rides on a joint's profile meets it at one point.
bool cam_check(const Entries *entries, size_t index, const Linkage *linkage, Err *err);

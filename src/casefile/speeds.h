// The speeds at the start, in the plane.
#pragma once

#include "casefile/entries.h"
#include "model/kinematics.h"

// Sets the speeds of motions that have the positions of the start. Those that the case gives must
// agree with ideal joints and drive, or it is refused. Where it gives none, a drive takes the
// bodies with it, as slow as the joints leave them, play or not.
bool speeds_find(const Entries *entries, const Linkage *linkage, Motion *motions, Err *err);

// Starts of pins and blocks that share the freedoms of their bodies.
#pragma once

#include "model/linkage.h"

#include <stdint.h>

// Whether pins and blocks cannot each be put anywhere in its play, whatever the others do: several
// of them are between two bodies, or close loops of ideal joints.
bool settle_is_shared(const Linkage *linkage, const Motion *motions);

// Moves the bodies to anywhere that ideal joints, drives and the play of all pins and blocks allow,
// from where all of them are in their play, and lets these start there.
void settle_place_together(Linkage *linkage, Motion *motions, uint64_t *seed);

// Closes the ideal joints, with pins and blocks where their bodies then have them. False where they
// cannot be closed.
bool settle_close_together(Linkage *linkage, Motion *motions);

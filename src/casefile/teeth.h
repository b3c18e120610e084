// What a case says about teeth: which gears mesh, and which rack and pinion.
#pragma once

#include "casefile/target.h"

// Stores the numbers of teeth of a pair of gears.
bool teeth_store(const Target *target, Gear *gear);

// Finds the bodies of every pair of gears on one carrier, and of every rack and pinion, with
// the pinion's radius, from the joints that guide them, once the joints' bodies are known and while
// anchors are those that the case gives in the world.
bool teeth_join(const Entries *entries, Linkage *linkage, Err *err);

// Gives teeth their anchors, gears their pitch radii and a rack its line, once anchors are those of
// the bodies' frames.
void teeth_place(Linkage *linkage, const Motion *motions);

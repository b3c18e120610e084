// What a case says about slots, in which a pin of another body plays.
#pragma once

#include "casefile/target.h"

// Stores length and width of a slot.
bool slot_store(const Target *target, Stop *stop);

// Checks that the pin of a joint fits into its slot, and that nothing else is its wall.
bool slot_check(const Entries *entries, size_t index, const Joint *joint, Err *err);

// Checks that pins start in their slots, once the bodies are placed.
bool slot_check_starts(const Entries *entries, const Linkage *linkage, Err *err);

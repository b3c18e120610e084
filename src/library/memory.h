// What a call took of memory, noted until it ends.
#pragma once

#include "base/call.h"

// Begins to note for a call; ends it, and gives back what was noted where the call broke off.
void memory_begin(Call *call);
void memory_end(Call *call, bool is_left);

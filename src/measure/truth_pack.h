// A truth as one flat piece of memory, so that a child can make it and its parent have it.
#pragma once

#include "measure/truth.h"

// Bytes that the truth of a scenario takes, whatever becomes of it.
size_t truth_pack_size(const Scenario *scenario);

// Copies the truth into that many bytes.
void truth_pack_write(const Truth *truth, void *packed);

// The truth that was packed, of the same scenario. The caller finishes it.
Truth truth_pack_read(const Scenario *scenario, const void *packed);

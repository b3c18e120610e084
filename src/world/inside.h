// The contacts of joints with play within one step of a world whose response to them is linear.
#pragma once

#include "world/world_response.h"

// Whether their mobility may change in the step: where they are few, in a world that passes no
// bound.
bool inside_may_drift(WorldResponse *response);

// Integrates the contacts of the active places over a step, s, to the impulses and their integrals.
// `is_found` is false where there are too many of them, or where that takes more local steps than
// there can be sense in. Fails where there is no memory.
JpStatus inside_run(WorldResponse *response, double step, bool *is_found, JpError *error);

// Books what the contacts that were integrated last did.
void inside_book(WorldResponse *response);

// Notes where the bodies, once they are moved, are not where the contacts of the step have brought
// them, by so much that forces are wrong.
void inside_judge(WorldResponse *response);

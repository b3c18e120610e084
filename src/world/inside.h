// The contacts of joints with play within one step of a world whose answer to them is linear.
#pragma once

#include "world/answer.h"

// Integrates the contacts of the active places over a step, s, to the impulses and their integrals.
// Returns false where there are too many of them, or where that takes more local steps than there
// can be sense in.
bool inside_run(Answer *answer, double step);

// Books what the contacts that were integrated last did.
void inside_book(Answer *answer);

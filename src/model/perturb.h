// Starts beside a start: the same mechanism, its free bodies a little faster or slower.
#pragma once

#include "model/scenario.h"

// Changes the speeds of all bodies that are not driven by a random amount, relative to the fastest
// body's speeds, that keeps every ideal joint closed. The member number is the seed; equal numbers
// give equal changes. Where no joint has play there is nothing to change.
void perturb_start(Scenario *scenario, double relative, unsigned member);

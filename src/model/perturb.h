// Starts beside a start: the same mechanism, its free bodies a little faster or slower.
#pragma once

#include "model/scenario.h"

// Changes the speeds of all bodies that are not driven by a random amount, relative to the scale of
// the scenario's speeds, as far as the ideal joints and the driver let it. The member number is the
// seed; equal numbers give equal changes. Where joints and driver leave no freedom nothing changes.
void perturb_start(Scenario *scenario, double relative, unsigned member);

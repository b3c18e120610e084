// Starts beside a start: the same mechanism, its bodies a little faster or slower.
//
// The size of a perturbation is that of the largest change of any body's speed relative to that
// body's own largest, as model/distance.h measures errors: a start of size r is r away. So neither
// units, frames and origins nor a pivot far away have a part in it.
#pragma once

#include "model/distance.h"

// Changes the speeds of the bodies in a random direction, by a change of the size given, as the
// ideal joints and the driver let it. The scales are those of the scenario's own motion. The member
// number is the seed; equal numbers give equal changes. False, and nothing changed, where joints
// and driver leave no freedom.
bool perturb_start(Scenario *scenario, const DistanceScale scales[LINKAGE_BODY_MAX], double size,
                   unsigned member);

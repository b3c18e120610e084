// The mechanism of a case as a world of SDF, for Gazebo classic.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

// Why there is no whole world of a case; NULL where there is one: all that plays in it is pins in
// holes.
const char *tune_sdf_model_lacks(const Scenario *scenario);

// Appends gravity, the model and its state at the start, elements of a world, with the surface of
// the collisions of pins and holes; and what SDF has no words for, a comment each.
void tune_sdf_model_write(const Scenario *scenario, const char *surface, Text *text);

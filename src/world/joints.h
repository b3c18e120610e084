// The places of all joints with play in a step.
#pragma once

#include "world/play.h"

// Notes how they are at the step's start.
void joints_start(JpWorld *world);

// Finds them where the step evaluates forces, with rows where contacts are integrated within it.
void joints_find(JpWorld *world, bool has_rows);

// The places of all joints with play in a step.
#pragma once

#include "world/play.h"

// Notes how they are at the step's start.
void joints_start(JpWorld *world);

// Finds them where the step evaluates forces, with rows where contacts are integrated within it.
void joints_find(JpWorld *world, bool has_rows);

// Where a place of a joint is now, in its first rows as the step has found them, and how fast it
// goes there.
void joints_now(JpJoint *joint, const Place *place, double at[2], double rate[2]);

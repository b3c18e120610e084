// The extremes of a closed-form motion whose crank turns at a speed over time.
#pragma once

#include "model/scenario.h"
#include "model/trajectory.h"

// Of one body between two times, s, with every joint ideal.
BodyExtremes driven_extremes(const Scenario *scenario, size_t body, double from_s, double to_s);

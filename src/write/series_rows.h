// The rows of a series, on any open stream.
#pragma once

#include "model/trajectory.h"

#include <stdio.h>

// Writes the head and one row a sample; the trajectory is complete.
void series_rows_write(const Scenario *scenario, const Trajectory *trajectory, FILE *stream);

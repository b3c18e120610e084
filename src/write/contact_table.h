// A row for each contact of a run.
#pragma once

#include "model/trajectory.h"

#include <stdio.h>

// Writes the head and the contacts in the order of their onsets; the trajectory is complete and has
// kept them.
void contact_table_write(const Trajectory *trajectory, FILE *stream);

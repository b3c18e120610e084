// A row for each contact of a run.
#pragma once

#include "model/trajectory.h"

// Writes the contacts in the order of their onsets, whole or not at all (write/row_file.h, where
// the file is claimed before). The trajectory is complete and has kept them. Fails as row_file_end
// does.
bool contact_table_write(const Trajectory *trajectory, const char *path, Err *err);

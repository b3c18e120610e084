// A row for each contact of a run.
#pragma once

#include "model/trajectory.h"

// Claims a file for the contacts of a linkage, and writes them in the order of their onsets, whole
// or not at all: CSV, JSON Lines or SQLite, whose table is `contacts` (write/row_file.h). The
// trajectory is complete and has kept them. They fail as row_file_claim and row_file_end do.
bool contact_table_claim(const Linkage *linkage, const char *user, const char *path, Err *err);
bool contact_table_write(const Trajectory *trajectory, const char *path, Err *err);

// A torque or a force, constant or over time, as a case writes it.
#pragma once

#include "casefile/entries.h"

// Reads `0.1 N m`, or a list of times and torques `[[0 s, 1 N m], [10 ms, 0 N m]]`, into points;
// the joint stays. A wrong value is an error with its place and what would be allowed.
bool torque_table_store(const Entry *entry, Torque *torque, Err *err);

// The rows of the ideal joints of a planar world in ODE, and whether they are independent.
#pragma once

#include "model/scenario.h"

// Counts the ideal joints' rows and makes sure that none follows from the others; fails with
// ERR_SOLVER where one does.
bool world_rows_check(const Scenario *scenario, const Motion *motions, size_t *row_count, Err *err);

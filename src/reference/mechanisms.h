// The reference's solvers: of one mechanism, and of several that share nothing but the ground.
// reference/reference.c chooses.
#pragma once

#include "model/solver.h"

extern const Solver REFERENCE_ONE;
extern const Solver REFERENCE_SEVERAL;

// How many coordinates the equations of a REFERENCE_ONE have.
size_t reference_coordinates(const void *state);

// What the model says of itself.
void reference_label(const Scenario *scenario, size_t coordinates,
                     char label[TRAJECTORY_LABEL_SIZE]);

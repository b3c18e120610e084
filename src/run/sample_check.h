// When a sample may be taken, and whether it is one.
#pragma once

#include "model/solver.h"

// Of a step: one that ends so little before a sample has reached it.
static const double RUN_ROUNDING = 1e-9;

// A solver marks a state that the joints do not determine by omegas that are no numbers: whether
// there are none in a part of a sample (NULL: in all of it).
bool run_check_sample(const Linkage *linkage, const SolverPart *part, const Sample *sample,
                      Err *err);

// Another machine, simulated: the same scenario, its numbers rounded otherwise.
#pragma once

#include "model/scenario.h"

// Moves every physical number of the scenario - lengths, masses, inertias, positions, speeds,
// gravity, material, contact, step and ERP - to a neighbouring double or leaves it, at random.
// Zeros, whole numbers that choose something, and the exponent of the law stay. Equal seeds give
// equal changes.
void shake_inputs(Scenario *scenario, unsigned seed);

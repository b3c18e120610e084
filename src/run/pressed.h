// The start with each pin on the wall of its hole.
#pragma once

#include "model/scenario.h"

// Puts each pin and each block with play, in the plane, on its wall where the reaction of an ideal
// joint would hold it, and the bodies accordingly; joints without such a reaction stay as they are.
// Fails with ERR_SOLVER, the scenario untouched, where the ideal mechanism and its drive do not
// determine motion and reactions.
bool pressed_start(Scenario *scenario, Err *err);

// The forces in the ideal joints of a linkage whose motion is known.
#pragma once

#include "model/response.h"
#include "model/scenario.h"
#include "model/trajectory.h"

// Fills in force, force_on_b and moment_on_b of the ideal joints, the drive's joint apart, from
// positions and accelerations. The response must have been prepared for the scenario's linkage.
// Returns false where the forces are not determined; the joints are then untouched. `lambda` is to
// work with: a number for each ideal row of the response.
bool ideal_forces_solve(const Scenario *scenario, const Motion *motions, const BodyLoad *loads,
                        Response *response, double *lambda, JointState *joints);

// Starts beside a start: the same mechanism, its bodies a little faster or slower.
//
// The size of a perturbation is that of the largest change of any body's speed relative to that
// body's own largest, as model/distance.h measures errors: a start of size r is r away. So neither
// units, frames and origins nor a pivot far away have a part in it.
#pragma once

#include "model/distance.h"
#include "model/nearest.h"

// Changes the speeds of the bodies in a random direction, by a change of the size given, as the
// ideal joints and the driver let it. The scales are those of the scenario's own motion. The member
// number is the seed; equal numbers give equal changes. False, and nothing changed, where joints
// and driver leave no freedom.
bool perturb_start(Scenario *scenario, const DistanceScale *scales, double size, unsigned member);

// All directions are found of linkages with so many bodies at most.
enum { PERTURB_BODY_MAX = 16, PERTURB_FREEDOM_MAX = 6 * PERTURB_BODY_MAX };

// Changes of the bodies' speeds that span all that joints and driver allow, each of length 1 in
//     |w|^2 = sum over bodies (w_omega / omega_b)^2 + (w_v / v_b)^2
// and at right angles to the others. Its size, as perturb_start has it, is 1 or less. In bodies
// that no joint connects but through the ground or the driven body all that holds for each group of
// them by itself: none feels the others' changes, so that one run serves all groups.
typedef struct PerturbBasis {
    size_t count; // freedoms, of the group with most of them
    SpeedChange changes[PERTURB_FREEDOM_MAX][PERTURB_BODY_MAX];
} PerturbBasis;

void perturb_basis(const Scenario *scenario, const DistanceScale *scales, PerturbBasis *basis);

// Adds a multiple of a change to the speeds of the start.
void perturb_along(Scenario *scenario, const SpeedChange *changes, double factor);

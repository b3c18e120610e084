// Starts beside a start: the same mechanism, its bodies a little faster or slower.
//
// The size of a perturbation is that of the largest change of any body's speed relative to that of
// the body's own fastest point. So neither units, frames and origins nor a pivot far away have a
// part in it.
#pragma once

#include "model/distance.h"
#include "model/nearest.h"

// What changes of one body's speeds are measured in.
typedef struct PerturbUnit {
    double moving;  // m/s: the largest speed of its fastest point
    double turning; // rad/s, with which its furthest point moves that fast
} PerturbUnit;

// Those of all bodies in a trajectory, at least a thousandth of the fastest body's, and the
// floor of a mechanism at rest.
void perturb_units(const Trajectory *reference, PerturbUnit *units);

// Changes the speeds of the bodies in a random direction, by a change of the size given, as the
// ideal joints and the driver let it. The units are those of the scenario's own motion. The member
// number is the seed; equal numbers give equal changes. False, and nothing changed, where joints
// and driver leave no freedom.
bool perturb_start(Scenario *scenario, const PerturbUnit *units, double size, unsigned member);

// All directions are found of linkages with so many bodies at most.
enum { PERTURB_BODY_MAX = 16, PERTURB_FREEDOM_MAX = 6 * PERTURB_BODY_MAX };

// Changes of the bodies' speeds that span all that joints and driver allow, each of length 1 in
//     |w|^2 = sum over the rates of a measure (|w_rate| / scale)^2
// and at right angles to the others: none is further away than 1 in that measure. In bodies
// that no joint connects but through the ground or the driven body all that holds for each group of
// them by itself: none feels the others' changes, so that one run serves all groups.
typedef struct PerturbBasis {
    size_t count; // freedoms, of the group with most of them
    SpeedChange changes[PERTURB_FREEDOM_MAX][PERTURB_BODY_MAX];
    // How many times larger than the others' its perturbation is to be: where a small change of the
    // bodies' speeds is a large one of the play in a joint, rounding would hide it.
    double stretch[PERTURB_FREEDOM_MAX];
} PerturbBasis;

void perturb_basis(const Scenario *scenario, const DistanceMeasure *measure,
                   const PerturbUnit *units, PerturbBasis *basis);

// Adds a multiple of a change to the speeds of the start.
void perturb_along(Scenario *scenario, const SpeedChange *changes, double factor);

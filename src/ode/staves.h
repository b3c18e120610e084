// A hole as a ring of convex staves that libccd is asked about, without ODE in between.
#pragma once

#include "ode/collider.h"

// The functions of a Collider, by libccd's Minkowski portal refinement or by its GJK and EPA.
void *staves_open(const Scenario *scenario, int joint);
bool staves_find_mpr(void *state, dGeomID hole, dGeomID pin, Collision *collision);
bool staves_find_gjk(void *state, dGeomID hole, dGeomID pin, Collision *collision);
void staves_close(void *state);

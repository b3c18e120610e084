// libccd asked as it comes, for comparison with how the program asks it: in metres, with its
// default tolerances, each body about its own centre.
#pragma once

#include "ode/plane/collider.h"

extern const Collider NAIVE_MPR;
extern const Collider NAIVE_GJK;

// All bodies of a world of ODE.
#pragma once

#include "world/play.h"

// Adds all bodies of the world by hand. JP_ERROR_NONE where ODE's list cannot be followed.
JpStatus listing_add_all(JpWorld *world, JpError *error);

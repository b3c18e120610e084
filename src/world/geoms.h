// The geoms of a caller's space: which bodies they are on, and where they touch.
#pragma once

#include "world/play.h"

// Makes the contacts of all pairs of geoms in the world's space, where bodies are. Those of bodies
// that a joint links are left out.
void geoms_touch(JpWorld *world);

// The number of bodies that geoms of the space are on, one for each geom; writes them where there
// is room.
size_t geoms_list(const JpWorld *world, dBodyID *bodies);

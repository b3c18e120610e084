// A world as a step finds it, and as it is left where the step fails.
#pragma once

#include "world/world_response.h"

// Notes everything that a step changes.
void found_keep(JpWorld *world);

// Puts it back, whatever the step was at. Contacts of the step are not taken away.
void found_put_back(JpWorld *world, WorldResponse *response);

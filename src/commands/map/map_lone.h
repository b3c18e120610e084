// The contact of `jointplay map --stiffness`, which needs no case.
#pragma once

#include "commands/map/map_options.h"

// Makes the scenario of one pin at its wall from the options, with the same words and checks as a
// case file, and puts mass, speed and steps into the settings. Without --clearance the hole is as
// wide as the steps need. Fails with ERR_USAGE.
bool map_lone_make(const MapOptions *options, Scenario *scenario, MappingSettings *settings,
                   Err *err);

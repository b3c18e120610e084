// The equations of motion in space as a system.
#pragma once

#include "reference/system.h"

// Makes the equations of motion of a scenario in space. Returns NULL with ERR_CASE where a contact
// law does not fit a joint. The caller frees them by their kind.
System *space_system_create(const Scenario *scenario, Err *err);

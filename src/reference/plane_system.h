// The plane's equations of motion as a system.
#pragma once

#include "reference/system.h"

// Makes the equations of motion of a scenario. Returns NULL with ERR_CASE where a contact law does
// not fit a joint. The caller frees them by
// their kind.
System *plane_system_create(const Scenario *scenario, Err *err);

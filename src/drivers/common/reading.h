// Reads the request of a run (docs/drivers.md).
#pragma once

#include "drivers/common/driver.h"

#include <jansson.h>

// The case of a request, which the program keeps to its end. What is wrong with it ends the
// program.
DriverCase *driver_read_case(const json_t *request);

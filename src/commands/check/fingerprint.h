// What the bits of a run depend on beside its case.
#pragma once

#include "write/settings_json.h"

// The fingerprint of the program and of the mathematical library's results on this processor:
// where both are the same, so are all bits of all runs.
void fingerprint_print(char text[BUILD_PRINT_SIZE]);

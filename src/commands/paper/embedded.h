// The paper's cases, inside the program: `jointplay paper` needs no file.
#pragma once

#include "model/scenario.h"

typedef enum EmbeddedCase {
    EMBEDDED_IDEAL_NOMINAL,
    EMBEDDED_IDEAL_STACKUP,
    EMBEDDED_STACKUP_POISSON,
    EMBEDDED_STACKUP_IMPACT,
    EMBEDDED_COUNT,
} EmbeddedCase;

// Loads one of them with the crank turning clockwise at 1000 rpm, as the paper's does. The scenario
// is untouched on failure.
bool embedded_load(EmbeddedCase which, Scenario *scenario, Err *err);

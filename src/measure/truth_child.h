// The truth of a scenario, computed in a child process, so that a crash cannot take the program
// down.
#pragma once

#include "measure/truth.h"

typedef struct TruthChild {
    const Scenario *scenario;
    double run_limit_s; // s, of each of the runs that the truth consists of
    void (*wait)(const char *doing, void *context); // a few times a second
    bool (*should_stop)(void *context);             // likewise; NULL: never
    void *context;
} TruthChild;

// Makes the truth; the caller finishes it. Fails with ERR_SOLVER where there is none or it was
// stopped, the truth then being zeroed. A truth that could not be certified says so in its message.
bool truth_child_make(const TruthChild *work, Truth *truth, Err *err);

// A setting as a C program of its own, that needs ODE and nothing else.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

typedef struct TuneCode {
    const Scenario *scenario; // with the setting applied
    const char *words;        // what the setting is, in one line
    const char *command;      // the command line that does the same, as a shell takes it
    double error;             // 1, measured
    double target;            // 1; INFINITY where none was asked for
} TuneCode;

// Appends the program. It prints the series as `jointplay run --series` writes it, the same numbers
// to the last bit, and on standard error the steps and the hash of the run. Fails with ERR_CASE
// where the contact law does not fit a joint.
bool tune_code_write(const TuneCode *code, Text *text, Err *err);

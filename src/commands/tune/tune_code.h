// A setting as a C program of its own, that needs ODE and nothing else.
#pragma once

#include "commands/tune/tune_code_text.h"

// Appends the program. It prints the series as `jointplay run --series` writes it, the same numbers
// to the last bit, and on standard error the steps and the hash of the run. Fails with ERR_CASE
// where the contact law does not fit a joint, and as tune_sources_write does.
bool tune_code_write(const TuneCode *code, Text *text, Err *err);

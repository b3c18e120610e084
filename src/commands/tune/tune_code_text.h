// What programs that are written have in common.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

typedef struct TuneCode {
    const Scenario *scenario; // with the setting applied
    const char *words;        // what the setting is, in one line
    const char *command;      // the command line that does the same, as a shell takes it
    double error;             // 1, measured
    double target;            // 1; INFINITY where none was asked for
    double step_first_s;      // of the setting: a program may need a shorter step
    double error_first;       // 1, of the program with that step; NAN where it has none
} TuneCode;

// Appends the comment in front: what this is, how it is compiled (as a shell takes it), of which
// case, setting and error, and the command that does the same.
void tune_code_head(const TuneCode *code, const char *what, const char *compile, Text *text);

// Appends a string constant; what is not plain ASCII is written by its octal number.
void tune_code_string(const char *string, Text *text);

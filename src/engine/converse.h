// Holds a conversation with another program: all of its input at once, its output line by line.
//
// Whatever the program does, the conversation ends: it is killed, with all that it has started,
// where it exceeds its time, writes more than anybody can want, or where a line is refused.
#pragma once

#include "base/err.h"

#include <stddef.h>

typedef struct Converse {
    const char *program; // path of it, run without a shell
    const char *input;
    size_t input_size;
    double time_limit_s; // by the clock on the wall; 0: none
    size_t output_most;  // bytes of its output
    // Takes a line of its output, without its end, which may be changed; false ends the program.
    bool (*take)(char *line, size_t size, void *context, Err *err);
    void *context;
} Converse;

// Fails with ERR_SOLVER, and says why and what stood last on the program's standard error, where
// it cannot be started, ends by a signal or with another exit status than 0, exceeds a limit or
// does not end after its output did; or with what `take` says.
bool converse(const Converse *with, Err *err);

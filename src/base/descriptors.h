// The descriptors 0, 1 and 2, which are standard input, output and error to every library and child
// process, whatever file they lead to.
#pragma once

#include "base/err.h"

#include <stdio.h>

// Leads those of the three that the caller closed to /dev/null, so that no file of ours is opened
// there and none of our messages goes into one. A closed stream stays of no use: reading from
// standard input or writing to standard output fails as before, while messages are dropped. Call it
// before anything is opened. ERR_FILE.
bool descriptors_reserve(Err *err);

// A stream of its own on a copy of one of the three, to be closed by the caller. NULL, with errno
// EBADF, where the descriptor cannot be read from or written to.
FILE *descriptors_stream(int descriptor, const char *mode);

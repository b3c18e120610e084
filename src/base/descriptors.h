// The descriptors that the caller opened, and files to be read. Those 0, 1 and 2 are standard
// input, output and error to every library and child process, whatever file they lead to.
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

// A stream on a file that is to be read, closed by the caller. NULL, with the reason in words,
// where it cannot be opened or is no regular file: a pipe that nobody writes to would be waited for
// for ever. What the caller opened and names by /dev/stdin or /dev/fd/N may be anything.
FILE *descriptors_open_file(const char *path, const char **reason);

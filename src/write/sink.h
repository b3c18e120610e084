// A stream into a file descriptor that remembers why a write failed: stdio keeps only that one did.
#pragma once

#include <stdio.h>

typedef struct Sink {
    int file;
    int reason; // errno of the first write that failed; 0 where none did
} Sink;

// A stream into an open file. Closing the stream closes the file; the sink must outlive both. What
// comes after a write that failed is dropped. NULL, with errno set, where there is no memory.
FILE *sink_open(Sink *sink, int file);

// Pieces of work on the processors that there are, at the same time.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// How many processors this process may use, at least 1.
size_t side_by_side_processors(void);

// One of `count` pieces. The caller's own thread takes the first, and others as it comes to them.
typedef void (*SideBySidePiece)(size_t index, bool is_callers, void *context);

// Does pieces 0 to count - 1, each once, by at most so many threads, the caller's among them, and
// returns when all are done. Pieces are begun in the order of their numbers; where there are no
// more threads to be had the caller's does them all. What a piece writes must be its own.
void side_by_side_run(size_t count, size_t threads, SideBySidePiece piece, void *context);

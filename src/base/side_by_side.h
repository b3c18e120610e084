// Pieces of work on the processors that there are, at the same time.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// How many processors this process may use, at least 1.
size_t side_by_side_processors(void);

// One piece. The caller's own thread takes the first, and others as it comes to them.
typedef void (*SideBySidePiece)(size_t index, bool is_callers, void *context);

// Does pieces 0 to count - 1, each once, by at most so many threads, the caller's among them, and
// returns when all are done. Pieces are begun in the order of their numbers; where there are no
// more threads to be had the caller's does them all. What a piece writes must be its own.
void side_by_side_run(size_t count, size_t threads, SideBySidePiece piece, void *context);

typedef enum SideBySideNext {
    SIDE_BY_SIDE_PIECE, // there is one
    SIDE_BY_SIDE_LATER, // there may be one when a piece that is going on has ended
    SIDE_BY_SIDE_NONE,  // and will be none
} SideBySideNext;

// Pieces some of which can begin only when others have ended.
typedef struct SideBySideTasks {
    size_t most; // pieces at the same time
    // The number of a piece to begin; called by one thread at a time, as `end` is.
    SideBySideNext (*next)(size_t *index, void *context);
    SideBySidePiece work;
    void (*end)(size_t index, void *context); // a piece has ended; NULL: nobody wants to know
    void *context;
} SideBySideTasks;

// Does pieces until there are none, by at most so many threads, as above.
void side_by_side_tasks(const SideBySideTasks *tasks, size_t threads);

// Does the pieces of several such lists, those of the earlier ones first, likewise.
void side_by_side_lists(const SideBySideTasks *lists, size_t count, size_t threads);

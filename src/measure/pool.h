// Pieces of work of one kind, done side by side by child processes and taken in as they end.
#pragma once

#include "measure/child.h"

typedef struct Pool {
    size_t jobs; // at a time
    ChildWork work;
    size_t result_size; // of one piece, as are the limits
    ChildLimits limits;
    // The next piece of work: its number, and its context, which lives until the next call. False
    // where none can begin now; asked again whenever one has ended.
    bool (*next)(void *owner, size_t *number, const void **context);
    // Takes in a piece that is over. The result holds something where the child's end is
    // CHILD_DONE. A failure ends everything.
    bool (*take)(void *owner, size_t number, const void *result, const Child *child, Err *err);
    // Called a few times a second; false: stop.
    bool (*wait)(void *owner);
    void *owner;
} Pool;

// Works until nothing is going on and nothing can begin. Where it is stopped, or something fails,
// what is going on is ended. Fails with ERR_SOLVER where the system has no process left, and as
// `take` does.
bool pool_run(const Pool *pool, Err *err);

// A piece of work in a child process, whose failure does not harm the caller.
#pragma once

#include "base/err.h"

#include <stddef.h>
#include <sys/types.h>

enum { CHILD_TEXT_SIZE = 128 };

// False under the address sanitizer, which needs terabytes of address space: a limit of memory is
// then ignored.
extern const bool CHILD_CAN_LIMIT_MEMORY;

// What a child may use; 0 stands for no limit.
typedef struct ChildLimits {
    double time_s;       // by the clock on the wall
    size_t memory_bytes; // of address space, that of the parent at the start included
} ChildLimits;

typedef enum ChildEnd {
    CHILD_RUNNING,
    CHILD_DONE,      // the whole result has arrived
    CHILD_EXITED,    // it exited without a result
    CHILD_SIGNALLED, // a signal ended it
    CHILD_TIMED_OUT, // it exceeded its time limit and was ended
    CHILD_NO_MEMORY, // it died of its limit of memory
    CHILD_CLOSED,    // it closed its pipe without a result, went on and was ended
} ChildEnd;

// Fills the result, which begins as all zeroes, from the context. It runs in the child: nothing
// else that it changes is seen by the parent, and nothing it leaves open is closed by anyone.
typedef void (*ChildWork)(const void *context, void *result);

typedef struct Child {
    ChildEnd end;
    int code;      // exit status of CHILD_EXITED, number of the signal of CHILD_SIGNALLED
    pid_t process; // from here on internal
    int channel;
    size_t order_size; // 0: no worker
    char *result;
    size_t result_size;
    size_t received;
    double started_s;
    ChildLimits limits;
} Child;

// Starts the work. The result, of that size, belongs to the caller, must outlive the child and
// holds something only once the child is CHILD_DONE. Should the caller die, the child dies as
// well; what the caller does on SIGINT and SIGTERM it does, too. Fails with ERR_SOLVER where the
// system has no process or pipe left; there is then nothing to end.
bool child_start(Child *child, ChildWork work, const void *context, void *result,
                 size_t result_size, ChildLimits limits, Err *err);

// Starts a worker: a child that lives on when its work is CHILD_DONE and can be given more of the
// same kind. The context is all that differs between two pieces of work; it is sent as it is, so
// that what it points to must have existed at the start and must not have changed since. A worker
// that does not come back with a result is a child that has ended, as any other.
bool child_start_worker(Child *child, ChildWork work, const void *context, size_t context_size,
                        void *result, size_t result_size, ChildLimits limits, Err *err);

// Whether a worker is there and has nothing to do. child_kill ends it.
bool child_is_at_rest(const Child *child);

// Gives a worker at rest its next piece of work; the result is as before. False where it is gone:
// it is then ended, and another one may be started.
bool child_order(Child *child, const void *context);

// Waits until one of the children that are running ends, at most so long; their ends stand in
// them. Returns at once where none is running.
void child_wait(Child *children, size_t count, double wait_s);

// Ends a child that is running or at rest; nothing is to be had from it. Accepts zeroed children.
void child_kill(Child *child);

// Asked in a child: whether memory was refused to it, by its limit or by the system, since errno
// was last set to 0.
bool child_lacks_memory(void);

// Whether the system refuses this process so many bytes, which are not kept.
bool child_is_refused(size_t bytes);

// How a child ended, in words: "ended by signal 6 (Aborted)".
void child_describe(const Child *child, char text[CHILD_TEXT_SIZE]);

// Pieces of work of one kind, done side by side by child processes and taken in as they end.

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
    // whether `take` takes in a piece that had no memory; else that fails, for what the others say
    // would lack it
    bool takes_no_memory;
    void *owner;
} Pool;

// Works until nothing is going on and nothing can begin. Where it is stopped, or something fails,
// what is going on is ended. Fails with ERR_SOLVER where the system has no process left or a piece
// had no memory, and as `take` does.
bool pool_run(const Pool *pool, Err *err);

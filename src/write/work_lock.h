// A lock that says "somebody works on this file", from opening to closing.
//
// It hangs on the open file and not on the process: other code of the process that opens and closes
// the file does not end it. Children inherit it, and die with their parent, but only just after it:
// so it is waited for, for a moment, and given up explicitly.
#pragma once

#include <stdbool.h>
#include <sys/types.h>

// Takes the lock on one byte of a file open for writing. Returns 0, EAGAIN where another process
// has it, or the errno of what went wrong.
int work_lock_take(int file, off_t byte);

void work_lock_give(int file, off_t byte);

// Whether anybody has it. Accepts a file that is not open (-1).
bool work_lock_is_taken(int file, off_t byte);

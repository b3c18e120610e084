// Memory that has to be there, and what happens where it is not.
//
// Code deep inside a computation allocates through these and never sees NULL. Where there is no
// memory the innermost guard of the thread is left, or, without a guard, the program ends. Between
// a guard and what allocates under it, all memory must belong to structures that whoever made the
// guard destroys, at every moment: nothing else is given back.
#pragma once

#include <setjmp.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct MemoryGuard {
    jmp_buf left; // where to go on
    struct MemoryGuard *outer;
    const char *mistake; // why it was left: NULL for want of memory; else what went wrong, static
} MemoryGuard;

// Puts a guard in place of the thread's; takes it away again. In between:
//     MemoryGuard guard;
//     memory_guard_begin(&guard);
//     if (setjmp(guard.left) == 0) { compute(); } else { there is no memory }
//     memory_guard_end(&guard);
void memory_guard_begin(MemoryGuard *guard);
void memory_guard_end(const MemoryGuard *guard);

// Whether the thread has a guard.
bool memory_is_guarded(void);

// Leaves the innermost guard of the thread, for want of memory or on a mistake; returns where there
// is none.
void memory_leave(const char *mistake);

// How the process ends where memory is refused to it outside any guard, in place of going on
// without: with so many bytes that were wanted, on whatever thread. It allocates nothing and does
// not return. NULL, the default, returns the refusal to whoever asked.
void memory_end_by(void (*end)(size_t bytes));

// Ends the process so; returns under a guard, or where there is no such way.
void memory_refuse(size_t bytes);

// Memory for so many elements: zeroed; as it comes; or what there was, in more room. One byte at
// least. Where these do not return, the old memory stays as it was.
void *memory_zeroed(size_t count, size_t size);
void *memory_plain(size_t count, size_t size);
void *memory_grown(void *old, size_t count, size_t size);

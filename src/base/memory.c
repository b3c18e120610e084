// Takes memory, and says so where there is none.
//
// The guard is the thread's own, so that worlds in several threads do not meet.
#include "base/memory.h"

#include <assert.h>
#include <stdint.h>
#include <stdlib.h>

static _Thread_local MemoryGuard *innermost;

void memory_guard_begin(MemoryGuard *guard)
{
    guard->outer = innermost;
    guard->mistake = NULL;
    innermost = guard;
}

void memory_guard_end(const MemoryGuard *guard)
{
    innermost = guard->outer;
}

bool memory_is_guarded(void)
{
    return innermost != NULL;
}

void memory_leave(const char *mistake)
{
    if (innermost != NULL) {
        innermost->mistake = mistake;
        longjmp(innermost->left, 1);
    }
}

static void (*end_process)(size_t bytes);

void memory_end_by(void (*end)(size_t bytes))
{
    end_process = end;
}

void memory_refuse(size_t bytes)
{
    if (innermost == NULL && end_process != NULL) {
        end_process(bytes);
    }
}

static void *present(void *made)
{
    if (made == NULL) {
        memory_leave(NULL);
    }
    assert(made != NULL);
    return made;
}

// The bytes of so many elements; what no memory has where they cannot be counted.
static size_t bytes_of(size_t count, size_t size)
{
    if (size > 0 && count > SIZE_MAX / size) {
        return SIZE_MAX;
    }
    return count * size > 0 ? count * size : 1;
}

void *memory_zeroed(size_t count, size_t size)
{
    return present(calloc(1, bytes_of(count, size)));
}

void *memory_plain(size_t count, size_t size)
{
    return present(malloc(bytes_of(count, size)));
}

void *memory_grown(void *old, size_t count, size_t size)
{
    return present(realloc(old, bytes_of(count, size)));
}

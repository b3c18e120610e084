// Arrays as long as they need to be.
#pragma once

#include "base/memory.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// An array of so many zeroed elements, which free() gives back. One without elements exists, too.
// Without the memory for it the program stops, or the guard is left (base/memory.h).
static inline void *zeroed(size_t count, size_t size)
{
    return memory_zeroed(count, size);
}

// A copy of an array, which free() gives back; NULL of NULL.
static inline void *zeroed_copy(const void *array, size_t count, size_t size)
{
    if (array == NULL) {
        return NULL;
    }
    void *copy = zeroed(count, size);
    memcpy(copy, array, count * size);
    return copy;
}

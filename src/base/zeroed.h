// Arrays as long as they need to be.
#pragma once

#include <assert.h>
#include <stdlib.h>

// An array of so many zeroed elements, which free() gives back. One without elements exists, too.
// Without the memory for it the program stops.
static inline void *zeroed(size_t count, size_t size)
{
    void *made = calloc(count > 0 ? count : 1, size);
    assert(made != NULL);
    return made;
}

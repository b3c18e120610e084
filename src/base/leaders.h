// Which things belong together: each leads to another of its set or to itself, and the last of that
// chain, the first of them all, stands for the set.
#pragma once

#include <stddef.h>

// Lets each thing stand for itself.
static inline void leaders_start(size_t *leaders, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        leaders[i] = i;
    }
}

// The thing that stands for the set of one.
static inline size_t leaders_find(size_t *leaders, size_t of)
{
    while (leaders[of] != of) {
        leaders[of] = leaders[leaders[of]];
        of = leaders[of];
    }
    return of;
}

// Makes one set of those of two.
static inline void leaders_join(size_t *leaders, size_t first, size_t second)
{
    const size_t a = leaders_find(leaders, first);
    const size_t b = leaders_find(leaders, second);
    leaders[a > b ? a : b] = a < b ? a : b;
}

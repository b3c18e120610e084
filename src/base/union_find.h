// Union-find: which things belong together. Each has a parent in its set, or itself; the last of
// that chain, its root, is the first thing of the set and stands for it.
#pragma once

#include <stddef.h>

// Lets each thing be a set of its own.
static inline void union_find_start(size_t *parents, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        parents[i] = i;
    }
}

// The root of the set that a thing is in.
static inline size_t union_find_root(size_t *parents, size_t of)
{
    while (parents[of] != of) {
        parents[of] = parents[parents[of]];
        of = parents[of];
    }
    return of;
}

// Makes one set of those of two.
static inline void union_find_join(size_t *parents, size_t first, size_t second)
{
    const size_t a = union_find_root(parents, first);
    const size_t b = union_find_root(parents, second);
    parents[a > b ? a : b] = a < b ? a : b;
}

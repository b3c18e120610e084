// Independent arrays in one piece of memory, which one free() gives back.
//
// A function that takes its arrays from a layout is called twice: with a layout that only counts,
// then with one that has the memory.
#pragma once

#include <stddef.h>

typedef struct MemoryLayout {
    char *memory; // NULL: the layout counts
    size_t used;  // bytes
} MemoryLayout;

// Room for an array of some elements, aligned for any type; NULL from a layout that counts.
static inline void *layout_take(MemoryLayout *layout, size_t count, size_t size)
{
    const size_t unit = sizeof(long double);
    const size_t start = layout->used;
    layout->used += (count * size + unit - 1) / unit * unit;
    return layout->memory != NULL ? layout->memory + start : NULL;
}

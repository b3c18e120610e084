// Things that wait, by two numbers: the one with the least first number comes first, and of equal
// ones that with the least second.
#pragma once

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>

typedef struct HeapItem {
    size_t first;
    size_t second;
} HeapItem;

// Zeroed it is empty; for heap_finish.
typedef struct Heap {
    size_t count;
    size_t room;
    HeapItem *items; // owned
} Heap;

static inline void heap_finish(Heap *heap)
{
    free(heap->items);
    *heap = (Heap){.count = 0};
}

static inline bool heap_comes_before(const HeapItem *a, const HeapItem *b)
{
    return a->first < b->first || (a->first == b->first && a->second < b->second);
}

static inline void heap_swap(HeapItem *a, HeapItem *b)
{
    const HeapItem kept = *a;
    *a = *b;
    *b = kept;
}

static inline void heap_push(Heap *heap, size_t first, size_t second)
{
    if (heap->count == heap->room) {
        heap->room = 2 * heap->room + 16;
        heap->items = realloc(heap->items, heap->room * sizeof *heap->items);
        assert(heap->items != NULL);
    }
    size_t i = heap->count++;
    heap->items[i] = (HeapItem){first, second};
    while (i > 0 && heap_comes_before(&heap->items[i], &heap->items[(i - 1) / 2])) {
        heap_swap(&heap->items[i], &heap->items[(i - 1) / 2]);
        i = (i - 1) / 2;
    }
}

// Takes out the one that comes first, of one or more.
static inline HeapItem heap_pop(Heap *heap)
{
    const HeapItem top = heap->items[0];
    heap->items[0] = heap->items[--heap->count];
    for (size_t i = 0;;) {
        size_t least = i;
        for (size_t k = 2 * i + 1; k <= 2 * i + 2 && k < heap->count; k++) {
            least = heap_comes_before(&heap->items[k], &heap->items[least]) ? k : least;
        }
        if (least == i) {
            return top;
        }
        heap_swap(&heap->items[i], &heap->items[least]);
        i = least;
    }
}

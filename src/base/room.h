// Room in lists that grow.
#pragma once

#include "base/memory.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// Gives a list of items of so many bytes room for at least `least` of them, and at least twice what
// it had, so that adding one by one costs little. New room is zeroed.
static inline void *room_grow(void *list, size_t *room, size_t least, size_t size)
{
    if (least <= *room) {
        return list;
    }
    const size_t grown = least > 2 * *room ? least : 2 * *room;
    char *made = (char *)memory_grown(list, grown, size);
    memset(made + *room * size, 0, (grown - *room) * size);
    *room = grown;
    return made;
}

// A copy of a list of so many items; NULL of none.
static inline void *room_copy(const void *list, size_t count, size_t size)
{
    if (count == 0) {
        return NULL;
    }
    return memcpy(memory_plain(count, size), list, count * size);
}

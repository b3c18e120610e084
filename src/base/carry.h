// What something carries from one step to the next, taken out of its fields and put back into them.
//
// One walk over the fields does both ways, so that nothing that is taken is forgotten when it is
// put back. Fields are copied byte by byte: they hold no pointers, and are put back into what was
// made from the same description by the same program.
#pragma once

#include "base/room.h"

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

typedef struct Carry {
    bool is_back; // into the fields; else out of them
    size_t used;  // bytes, taken or put back so far
    size_t size;  // bytes, taken in all
    size_t room;
    char *bytes; // owned
} Carry;

// Begins a walk: one that takes, or one that puts back what the last one took.
static inline void carry_begin(Carry *carry, bool is_back)
{
    carry->is_back = is_back;
    carry->used = 0;
    carry->size = is_back ? carry->size : 0;
}

// Gives its memory back; it is then empty.
static inline void carry_finish(Carry *carry)
{
    free(carry->bytes);
    memset(carry, 0, sizeof *carry);
}

static inline void carry_bytes(Carry *carry, void *at, size_t size)
{
    if (size == 0) {
        return;
    }
    if (carry->is_back) {
        assert(carry->used + size <= carry->size);
        memcpy(at, carry->bytes + carry->used, size);
    } else {
        carry->bytes = (char *)room_grow(carry->bytes, &carry->room, carry->used + size, 1);
        memcpy(carry->bytes + carry->used, at, size);
        carry->size += size;
    }
    carry->used += size;
}

// A field that is no pointer, and an array of so many elements.
#define CARRY(carry, field)              carry_bytes((carry), &(field), sizeof(field))
#define CARRY_ARRAY(carry, array, count) carry_bytes((carry), (array), (count) * sizeof *(array))

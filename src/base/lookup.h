// Which of many things has this name? Numbers by the hash of what they stand for.
//
// A lookup does not know the things: what has the same hash is compared by the caller.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LOOKUP_NONE = -1 };

typedef struct LookupSlot {
    uint64_t hash;
    size_t number_and_one; // 0: empty
} LookupSlot;

// Zeroed it is empty; for lookup_finish.
typedef struct Lookup {
    size_t count;
    size_t room;       // a power of two, or 0
    LookupSlot *slots; // owned
} Lookup;

void lookup_finish(Lookup *lookup);
Lookup lookup_copy(const Lookup *lookup);

void lookup_add(Lookup *lookup, uint64_t hash, size_t number);

// The number that was added with this hash and is the one sought, or LOOKUP_NONE. Of several that
// are, any one.
int lookup_find(const Lookup *lookup, uint64_t hash,
                bool (*is_it)(size_t number, const void *sought), const void *sought);

// The hash of a text that ends in a zero.
uint64_t lookup_hash(const char *text);

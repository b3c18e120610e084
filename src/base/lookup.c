// Finds numbers by the hash of what they stand for.
#include "base/lookup.h"

#include "base/hash.h"
#include "base/room.h"

enum { ROOM_LEAST = 16 };

void lookup_finish(Lookup *lookup)
{
    free(lookup->slots);
    *lookup = (Lookup){.count = 0};
}

Lookup lookup_copy(const Lookup *lookup)
{
    Lookup copy = *lookup;
    copy.slots = room_copy(lookup->slots, lookup->room, sizeof *copy.slots);
    return copy;
}

static void put(Lookup *lookup, LookupSlot slot)
{
    size_t at = slot.hash & (lookup->room - 1);
    while (lookup->slots[at].number_and_one != 0) {
        at = (at + 1) & (lookup->room - 1);
    }
    lookup->slots[at] = slot;
}

// Twice the room, at the most half full.
static void grow(Lookup *lookup)
{
    const Lookup old = *lookup;
    lookup->room = old.room == 0 ? ROOM_LEAST : 2 * old.room;
    lookup->slots = calloc(lookup->room, sizeof *lookup->slots);
    assert(lookup->slots != NULL);
    for (size_t i = 0; i < old.room; i++) {
        if (old.slots[i].number_and_one != 0) {
            put(lookup, old.slots[i]);
        }
    }
    free(old.slots);
}

void lookup_add(Lookup *lookup, uint64_t hash, size_t number)
{
    if (2 * (lookup->count + 1) > lookup->room) {
        grow(lookup);
    }
    put(lookup, (LookupSlot){hash, number + 1});
    lookup->count++;
}

int lookup_find(const Lookup *lookup, uint64_t hash,
                bool (*is_it)(size_t number, const void *sought), const void *sought)
{
    if (lookup->room == 0) {
        return LOOKUP_NONE;
    }
    for (size_t at = hash & (lookup->room - 1); lookup->slots[at].number_and_one != 0;
         at = (at + 1) & (lookup->room - 1)) {
        const LookupSlot *slot = &lookup->slots[at];
        if (slot->hash == hash && is_it(slot->number_and_one - 1, sought)) {
            return (int)(slot->number_and_one - 1);
        }
    }
    return LOOKUP_NONE;
}

uint64_t lookup_hash(const char *text)
{
    return hash_bytes(HASH_START, text, strlen(text));
}

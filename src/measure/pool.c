// How do several pieces of work go on at a time?
//
// fill the free slots -> wait -> take in what has ended.
#include "measure/pool.h"

#include <assert.h>
#include <stdlib.h>

static const double PAUSE_S = 0.2; // between two calls of `wait`

// A process at work, by slot.
typedef struct Slot {
    bool is_busy;
    size_t number; // of its piece
    void *result;  // owned
} Slot;

typedef struct Slots {
    Slot *slots;
    Child *children;
    size_t busy;
} Slots;

static void open_slots(const Pool *pool, Slots *slots)
{
    *slots = (Slots){.slots = calloc(pool->jobs, sizeof *slots->slots),
                     .children = calloc(pool->jobs, sizeof *slots->children)};
    assert(slots->slots != NULL && slots->children != NULL);
    for (size_t i = 0; i < pool->jobs; i++) {
        slots->slots[i].result = malloc(pool->result_size);
        assert(slots->slots[i].result != NULL);
    }
}

static void close_slots(const Pool *pool, Slots *slots)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        child_kill(&slots->children[i]);
        free(slots->slots[i].result);
    }
    free(slots->slots);
    free(slots->children);
}

static bool fill(const Pool *pool, Slots *slots, Err *err)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        Slot *slot = &slots->slots[i];
        const void *context;
        if (slot->is_busy) {
            continue;
        }
        if (!pool->next(pool->owner, &slot->number, &context)) {
            return true;
        }
        if (!child_start(&slots->children[i], pool->work, context, slot->result, pool->result_size,
                         pool->limits, err)) {
            return false;
        }
        slot->is_busy = true;
        slots->busy++;
    }
    return true;
}

static bool take(const Pool *pool, Slots *slots, Err *err)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        Slot *slot = &slots->slots[i];
        const Child *child = &slots->children[i];
        if (!slot->is_busy || child->end == CHILD_RUNNING) {
            continue;
        }
        slot->is_busy = false;
        slots->busy--;
        if (!pool->take(pool->owner, slot->number, slot->result, child, err)) {
            return false;
        }
    }
    return true;
}

bool pool_run(const Pool *pool, Err *err)
{
    assert(pool->jobs >= 1);
    Slots slots;
    open_slots(pool, &slots);
    bool is_going = fill(pool, &slots, err);
    while (is_going && slots.busy > 0 && pool->wait(pool->owner)) {
        child_wait(slots.children, pool->jobs, PAUSE_S);
        is_going = take(pool, &slots, err) && fill(pool, &slots, err);
    }
    close_slots(pool, &slots);
    return is_going;
}

// Stands between the library and malloc: notes what a call takes, and leaves the call where there
// is no more.
//
// The linker's --wrap sends every malloc, calloc, realloc, free, strdup and strndup of the objects
// in the library here, and no others: the process and the libraries below keep theirs. Blocks are
// noted in stripes by their address, for a call may work in several threads.
#include "library/memory.h"

#include "base/memory.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum {
    STRIPE_BITS = 4,
    STRIPE_COUNT = 1 << STRIPE_BITS,
    ROOM_LEAST = 64,
};

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void __wrap_free(void *block);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t most);
_Noreturn void __real___assert_fail(const char *claim, const char *file, unsigned line,
                                    const char *function);
_Noreturn void __wrap___assert_fail(const char *claim, const char *file, unsigned line,
                                    const char *function);

// A set of addresses: open addressing, at most half full.
typedef struct Stripe {
    pthread_mutex_t lock;
    size_t count;
    size_t room;   // a power of two, or 0
    void **blocks; // NULL: empty
} Stripe;

typedef struct Blocks {
    Stripe stripes[STRIPE_COUNT];
} Blocks;

static uint64_t mix(const void *block)
{
    return ((uint64_t)(uintptr_t)block >> 4) * 0x9e3779b97f4a7c15u;
}

static Stripe *stripe_of(Blocks *blocks, const void *block)
{
    return &blocks->stripes[mix(block) >> (64 - STRIPE_BITS)];
}

static size_t slot_of(const Stripe *stripe, const void *block)
{
    return (size_t)(mix(block) >> 8) & (stripe->room - 1);
}

// Where a block stands in a stripe that has room, or would.
static size_t find_slot(const Stripe *stripe, const void *block)
{
    size_t slot = slot_of(stripe, block);
    while (stripe->blocks[slot] != NULL && stripe->blocks[slot] != block) {
        slot = (slot + 1) & (stripe->room - 1);
    }
    return slot;
}

static bool stripe_grow(Stripe *stripe)
{
    const size_t room = stripe->room > 0 ? 2 * stripe->room : ROOM_LEAST;
    void **blocks = __real_calloc(room, sizeof *blocks);
    if (blocks == NULL) {
        return false;
    }
    Stripe grown = {.room = room, .blocks = blocks};
    for (size_t i = 0; i < stripe->room; i++) {
        if (stripe->blocks[i] != NULL) {
            blocks[find_slot(&grown, stripe->blocks[i])] = stripe->blocks[i];
        }
    }
    __real_free(stripe->blocks);
    stripe->room = room;
    stripe->blocks = blocks;
    return true;
}

// False where there is no room to note it.
static bool blocks_add(Blocks *blocks, void *block)
{
    Stripe *stripe = stripe_of(blocks, block);
    pthread_mutex_lock(&stripe->lock);
    const bool has_room = 2 * (stripe->count + 1) <= stripe->room || stripe_grow(stripe);
    if (has_room) {
        stripe->blocks[find_slot(stripe, block)] = block;
        stripe->count++;
    }
    pthread_mutex_unlock(&stripe->lock);
    return has_room;
}

// Closes the gap that a block leaves, so that those behind it are found.
static void close_gap(Stripe *stripe, size_t gap)
{
    const size_t last = stripe->room - 1;
    for (size_t slot = (gap + 1) & last; stripe->blocks[slot] != NULL; slot = (slot + 1) & last) {
        const size_t home = slot_of(stripe, stripe->blocks[slot]);
        if (((slot - home) & last) >= ((slot - gap) & last)) {
            stripe->blocks[gap] = stripe->blocks[slot];
            gap = slot;
        }
    }
    stripe->blocks[gap] = NULL;
}

// Whether it was noted.
static bool blocks_remove(Blocks *blocks, void *block)
{
    Stripe *stripe = stripe_of(blocks, block);
    bool is_noted = false;
    pthread_mutex_lock(&stripe->lock);
    if (stripe->count > 0) {
        const size_t slot = find_slot(stripe, block);
        is_noted = stripe->blocks[slot] != NULL;
        if (is_noted) {
            close_gap(stripe, slot);
            stripe->count--;
        }
    }
    pthread_mutex_unlock(&stripe->lock);
    return is_noted;
}

void memory_begin(Call *call)
{
    Blocks *blocks = __real_calloc(1, sizeof *blocks);
    for (size_t i = 0; blocks != NULL && i < STRIPE_COUNT; i++) {
        pthread_mutex_init(&blocks->stripes[i].lock, NULL);
    }
    call->blocks = blocks;
}

void memory_end(Call *call, bool is_left)
{
    Blocks *blocks = call->blocks;
    for (size_t i = 0; blocks != NULL && i < STRIPE_COUNT; i++) {
        Stripe *stripe = &blocks->stripes[i];
        for (size_t k = 0; is_left && k < stripe->room; k++) {
            __real_free(stripe->blocks[k]);
        }
        __real_free(stripe->blocks);
        pthread_mutex_destroy(&stripe->lock);
    }
    __real_free(blocks);
    call->blocks = NULL;
}

// Notes what was made in a call, or leaves it.
static void *noted(void *made)
{
    Call *call = call_current();
    if (call == NULL) {
        return made;
    }
    if (made != NULL && call->blocks != NULL && blocks_add(call->blocks, made)) {
        return made;
    }
    __real_free(made);
    memory_leave(NULL);
    return NULL;
}

void *__wrap_malloc(size_t size)
{
    return noted(__real_malloc(size > 0 ? size : 1));
}

void *__wrap_calloc(size_t count, size_t size)
{
    return noted(__real_calloc(count > 0 ? count : 1, size > 0 ? size : 1));
}

// A block that is older than the call stays its owner's.
void *__wrap_realloc(void *old, size_t size)
{
    Call *call = call_current();
    if (old == NULL) {
        return __wrap_malloc(size);
    }
    if (call == NULL || call->blocks == NULL) {
        return __real_realloc(old, size > 0 ? size : 1);
    }
    const bool is_noted = blocks_remove(call->blocks, old);
    void *made = __real_realloc(old, size > 0 ? size : 1);
    if (is_noted) {
        // the slot that was just left has room for it
        blocks_add(call->blocks, made != NULL ? made : old);
    }
    if (made == NULL) {
        memory_leave(NULL);
    }
    return made;
}

void __wrap_free(void *block)
{
    const Call *call = call_current();
    if (block != NULL && call != NULL && call->blocks != NULL) {
        blocks_remove(call->blocks, block);
    }
    __real_free(block);
}

char *__wrap_strndup(const char *text, size_t most)
{
    const size_t length = strnlen(text, most);
    char *copy = __wrap_malloc(length + 1);
    if (copy != NULL) {
        memcpy(copy, text, length);
        copy[length] = '\0';
    }
    return copy;
}

char *__wrap_strdup(const char *text)
{
    return __wrap_strndup(text, strlen(text));
}

void __wrap___assert_fail(const char *claim, const char *file, unsigned line, const char *function)
{
    if (call_current() != NULL) {
        memory_leave(claim);
    }
    __real___assert_fail(claim, file, line, function);
}

// jansson says by NULL or -1 that it had no memory, which all that makes JSON may ignore.

json_t *__real_json_object(void);
json_t *__real_json_array(void);
json_t *__real_json_integer(json_int_t value);
json_t *__real_json_real(double value);
int __real_json_object_set_new(json_t *object, const char *key, json_t *value);
int __real_json_array_append_new(json_t *array, json_t *value);
char *__real_json_dumps(const json_t *value, size_t flags);
json_t *__wrap_json_object(void);
json_t *__wrap_json_array(void);
json_t *__wrap_json_integer(json_int_t value);
json_t *__wrap_json_real(double value);
int __wrap_json_object_set_new(json_t *object, const char *key, json_t *value);
int __wrap_json_array_append_new(json_t *array, json_t *value);
char *__wrap_json_dumps(const json_t *value, size_t flags);

static void *json_made(void *made)
{
    if (made == NULL && call_current() != NULL) {
        memory_leave(NULL);
    }
    return made;
}

json_t *__wrap_json_object(void)
{
    return json_made(__real_json_object());
}

json_t *__wrap_json_array(void)
{
    return json_made(__real_json_array());
}

json_t *__wrap_json_integer(json_int_t value)
{
    return json_made(__real_json_integer(value));
}

json_t *__wrap_json_real(double value)
{
    json_t *made = __real_json_real(value);
    return isfinite(value) ? json_made(made) : made;
}

int __wrap_json_object_set_new(json_t *object, const char *key, json_t *value)
{
    const int status = __real_json_object_set_new(object, key, value);
    json_made(status == 0 ? object : NULL);
    return status;
}

int __wrap_json_array_append_new(json_t *array, json_t *value)
{
    const int status = __real_json_array_append_new(array, value);
    json_made(status == 0 ? array : NULL);
    return status;
}

// Its memory is jansson's own way of asking for it.
char *__wrap_json_dumps(const json_t *value, size_t flags)
{
    return json_made(__real_json_dumps(value, flags));
}

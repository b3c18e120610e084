// Lists the bodies of a world of ODE.
//
// ODE tells their number (world/bodies.h) and no more; it chains them, the newest first, by a
// pointer in each to the next. Where that stands in a body is found out, by three bodies made for
// it: it is the one place that holds the second in the third and the first in the second. The chain
// is followed only if such a place exists, as far as there are bodies, and has to end there.
#include "world/listing.h"

#include "world/fault.h"

#include <stdlib.h>
#include <string.h>

enum {
    PROBES = 3,
    WORDS = 8, // of a body that are looked at: ODE's begins with what all its objects have
};

static dBodyID word_of(dBodyID body, size_t word)
{
    dBodyID held = NULL;
    memcpy(&held, (const char *)body + word * sizeof held, sizeof held);
    return held;
}

// Where a body's next one stands; WORDS where that is not found.
static size_t find_next(const dBodyID probes[PROBES])
{
    for (size_t word = 0; word < WORDS; word++) {
        if (word_of(probes[2], word) == probes[1] && word_of(probes[1], word) == probes[0]) {
            return word;
        }
    }
    return WORDS;
}

// Makes the probes, the first ones before ODE has no memory for more. Returns false then.
static bool make_probes(dWorldID world, dBodyID probes[PROBES])
{
    Fault fault;
    fault_begin(&fault);
    if (setjmp(fault.left) == 0) {
        for (size_t i = 0; i < PROBES; i++) {
            probes[i] = dBodyCreate(world);
        }
        fault_end(&fault);
        return true;
    }
    fault_end(&fault);
    return false;
}

// Lists so many bodies that were there before the probes; false where the chain is another.
static bool list_bodies(const dBodyID probes[PROBES], dBodyID *bodies, size_t count)
{
    const size_t next = find_next(probes);
    dBodyID at = next < WORDS ? word_of(probes[0], next) : NULL;
    size_t listed = 0;
    while (listed < count && at != NULL) {
        bodies[listed++] = at;
        at = word_of(at, next);
    }
    return listed == count && at == NULL;
}

// Lists all bodies that there are.
static JpStatus list(JpWorld *world, dBodyID *bodies, size_t count, JpError *error)
{
    dBodyID probes[PROBES] = {NULL};
    const bool has_memory = make_probes(world->id, probes);
    const bool is_listed = has_memory && list_bodies(probes, bodies, count);
    for (size_t i = 0; i < PROBES; i++) {
        if (probes[i] != NULL) {
            dBodyDestroy(probes[i]);
        }
    }
    if (!has_memory) {
        return refusal(error, JP_ERROR_MEMORY, "ODE has no memory for a body");
    }
    return is_listed ? refusal_none(error)
                     : refusal(error, JP_ERROR_NONE,
                               "this version of ODE does not show which bodies its world has; add "
                               "each with jp_world_add_body");
}

static bool add_bodies(JpWorld *world, const dBodyID *bodies, size_t count)
{
    for (size_t i = count; i > 0; i--) {
        BodyRecord *record = bodies_add(&world->bodies, bodies[i - 1]);
        if (record == NULL) {
            return false;
        }
        record->is_added = true;
    }
    return true;
}

JpStatus listing_add_all(JpWorld *world, JpError *error)
{
    const long count = bodies_count(world->id);
    if (count < 0) {
        return refusal(error, JP_ERROR_MEMORY, "the bodies of the world could not be counted");
    }
    dBodyID *bodies = malloc(((size_t)count + 1) * sizeof *bodies);
    if (bodies == NULL) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for the world's bodies");
    }
    JpStatus status = list(world, bodies, (size_t)count, error);
    if (status == JP_OK && !add_bodies(world, bodies, (size_t)count)) {
        status = refusal(error, JP_ERROR_MEMORY, "there is no memory for the world's bodies");
    }
    free(bodies);
    return status;
}

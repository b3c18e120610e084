// How do several pieces of work go on at a time?
//
// fill the free places -> wait -> take in what has ended.
#include "measure/pool.h"

#include <assert.h>
#include <stdlib.h>

static const double PAUSE_S = 0.2; // between two calls of `wait`

// A process at work, by place.
typedef struct Place {
    bool is_busy;
    size_t number; // of its piece
    void *result;  // owned
} Place;

typedef struct Places {
    Place *places;
    Child *children;
    size_t busy;
} Places;

static void open_places(const Pool *pool, Places *places)
{
    *places = (Places){.places = calloc(pool->jobs, sizeof *places->places),
                       .children = calloc(pool->jobs, sizeof *places->children)};
    assert(places->places != NULL && places->children != NULL);
    for (size_t i = 0; i < pool->jobs; i++) {
        places->places[i].result = malloc(pool->result_size);
        assert(places->places[i].result != NULL);
    }
}

static void close_places(const Pool *pool, Places *places)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        child_kill(&places->children[i]);
        free(places->places[i].result);
    }
    free(places->places);
    free(places->children);
}

static bool fill(const Pool *pool, Places *places, Err *err)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        Place *place = &places->places[i];
        const void *context;
        if (place->is_busy) {
            continue;
        }
        if (!pool->next(pool->owner, &place->number, &context)) {
            return true;
        }
        if (!child_start(&places->children[i], pool->work, context, place->result,
                         pool->result_size, pool->limits, err)) {
            return false;
        }
        place->is_busy = true;
        places->busy++;
    }
    return true;
}

static bool take(const Pool *pool, Places *places, Err *err)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        Place *place = &places->places[i];
        const Child *child = &places->children[i];
        if (!place->is_busy || child->end == CHILD_RUNNING) {
            continue;
        }
        place->is_busy = false;
        places->busy--;
        if (!pool->take(pool->owner, place->number, place->result, child, err)) {
            return false;
        }
    }
    return true;
}

bool pool_run(const Pool *pool, Err *err)
{
    assert(pool->jobs >= 1);
    Places places;
    open_places(pool, &places);
    bool is_going = fill(pool, &places, err);
    while (is_going && places.busy > 0 && pool->wait(pool->owner)) {
        child_wait(places.children, pool->jobs, PAUSE_S);
        is_going = take(pool, &places, err) && fill(pool, &places, err);
    }
    close_places(pool, &places);
    return is_going;
}

// How are pieces of work done on several processors at the same time?
//
// Threads take the next number from one counter. No result depends on who took which.
#define _GNU_SOURCE // sched_getaffinity
#include "base/side_by_side.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

// more threads than any machine at hand has processors to spare
enum { HELPERS_MOST = 63 };

typedef struct Work {
    size_t count;
    SideBySidePiece piece;
    void *context;
    atomic_size_t next;
} Work;

size_t side_by_side_processors(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0) {
        return 1;
    }
    const int count = CPU_COUNT(&set);
    return count > 1 ? (size_t)count : 1;
}

static void take_pieces(Work *work, bool is_callers)
{
    size_t index = atomic_fetch_add(&work->next, 1);
    while (index < work->count) {
        work->piece(index, is_callers, work->context);
        index = atomic_fetch_add(&work->next, 1);
    }
}

static void *help(void *work)
{
    take_pieces(work, false);
    return NULL;
}

void side_by_side_run(size_t count, size_t threads, SideBySidePiece piece, void *context)
{
    if (count == 0) {
        return;
    }
    // the first piece is the caller's, whoever is faster
    Work work = {.count = count, .piece = piece, .context = context, .next = 1};
    pthread_t helpers[HELPERS_MOST];
    size_t helper_count = 0;
    while (helper_count + 1 < threads && helper_count + 1 < count && helper_count < HELPERS_MOST &&
           pthread_create(&helpers[helper_count], NULL, help, &work) == 0) {
        helper_count++;
    }
    piece(0, true, context);
    take_pieces(&work, true);
    for (size_t i = 0; i < helper_count; i++) {
        pthread_join(helpers[i], NULL);
    }
}

// Does pieces of work on several processors at the same time.
//
// Threads ask for the next one, one after the other. No result may depend on who took which.
#define _GNU_SOURCE // sched_getaffinity
#include "base/side_by_side.h"

#include <pthread.h>
#include <sched.h>

// more threads than any machine at hand has processors to spare
enum { HELPERS_MOST = 63 };

typedef struct Work {
    const SideBySideTasks *tasks;
    pthread_mutex_t lock; // of whoever asks for a piece, or says that one has ended
    pthread_cond_t has_ended;
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

// The next piece, after a wait where that is needed; false where there is none. Holds the lock.
static bool find_piece(Work *work, size_t *index)
{
    const SideBySideTasks *tasks = work->tasks;
    SideBySideNext next = tasks->next(index, tasks->context);
    while (next == SIDE_BY_SIDE_LATER) {
        pthread_cond_wait(&work->has_ended, &work->lock);
        next = tasks->next(index, tasks->context);
    }
    return next == SIDE_BY_SIDE_PIECE;
}

// Does a piece without the lock, which it holds before and after.
static void do_piece(Work *work, size_t index, bool is_callers)
{
    const SideBySideTasks *tasks = work->tasks;
    pthread_mutex_unlock(&work->lock);
    tasks->work(index, is_callers, tasks->context);
    pthread_mutex_lock(&work->lock);
    if (tasks->end != NULL) {
        tasks->end(index, tasks->context);
    }
    pthread_cond_broadcast(&work->has_ended);
}

static void take_pieces(Work *work, bool is_callers)
{
    size_t index;
    while (find_piece(work, &index)) {
        do_piece(work, index, is_callers);
    }
}

static void *help(void *context)
{
    Work *work = context;
    pthread_mutex_lock(&work->lock);
    take_pieces(work, false);
    pthread_mutex_unlock(&work->lock);
    return NULL;
}

void side_by_side_tasks(const SideBySideTasks *tasks, size_t threads)
{
    Work work = {
        .tasks = tasks,
        .lock = PTHREAD_MUTEX_INITIALIZER,
        .has_ended = PTHREAD_COND_INITIALIZER,
    };
    pthread_t helpers[HELPERS_MOST];
    size_t helper_count = 0;
    size_t first;
    pthread_mutex_lock(&work.lock);
    // the first piece is the caller's, whoever is faster
    if (find_piece(&work, &first)) {
        while (helper_count + 1 < threads && helper_count + 1 < tasks->most &&
               helper_count < HELPERS_MOST &&
               pthread_create(&helpers[helper_count], NULL, help, &work) == 0) {
            helper_count++;
        }
        do_piece(&work, first, true);
        take_pieces(&work, true);
    }
    pthread_mutex_unlock(&work.lock);
    for (size_t i = 0; i < helper_count; i++) {
        pthread_join(helpers[i], NULL);
    }
}

// Pieces that need nothing of one another.
typedef struct Row {
    size_t count;
    size_t next;
    SideBySidePiece piece;
    void *context;
} Row;

static SideBySideNext next_of_row(size_t *index, void *context)
{
    Row *row = context;
    *index = row->next;
    if (row->next == row->count) {
        return SIDE_BY_SIDE_NONE;
    }
    row->next++;
    return SIDE_BY_SIDE_PIECE;
}

static void do_one_of_row(size_t index, bool is_callers, void *context)
{
    const Row *row = context;
    row->piece(index, is_callers, row->context);
}

void side_by_side_run(size_t count, size_t threads, SideBySidePiece piece, void *context)
{
    Row row = {count, 0, piece, context};
    const SideBySideTasks tasks = {
        .most = count,
        .next = next_of_row,
        .work = do_one_of_row,
        .context = &row,
    };
    side_by_side_tasks(&tasks, threads);
}

// Several lists as one: the number of a piece is that in its list, times the number of lists, and
// the list's.
typedef struct Lists {
    const SideBySideTasks *lists;
    size_t count;
} Lists;

static SideBySideNext next_of_lists(size_t *index, void *context)
{
    const Lists *all = context;
    SideBySideNext next = SIDE_BY_SIDE_NONE;
    for (size_t i = 0; i < all->count && next != SIDE_BY_SIDE_PIECE; i++) {
        const SideBySideNext of = all->lists[i].next(index, all->lists[i].context);
        if (of == SIDE_BY_SIDE_PIECE) {
            *index = *index * all->count + i;
        }
        next = of == SIDE_BY_SIDE_NONE ? next : of;
    }
    return next;
}

static void do_one_of_lists(size_t index, bool is_callers, void *context)
{
    const Lists *all = context;
    const SideBySideTasks *list = &all->lists[index % all->count];
    list->work(index / all->count, is_callers, list->context);
}

static void end_one_of_lists(size_t index, void *context)
{
    const Lists *all = context;
    const SideBySideTasks *list = &all->lists[index % all->count];
    if (list->end != NULL) {
        list->end(index / all->count, list->context);
    }
}

void side_by_side_lists(const SideBySideTasks *lists, size_t count, size_t threads)
{
    Lists all = {lists, count};
    SideBySideTasks tasks = {
        .next = next_of_lists,
        .work = do_one_of_lists,
        .end = end_one_of_lists,
        .context = &all,
    };
    for (size_t i = 0; i < count; i++) {
        tasks.most += lists[i].most;
    }
    side_by_side_tasks(&tasks, threads);
}

// Does pieces of work on several processors at the same time.
//
// Threads ask for the next one, one after the other. No result may depend on who took which. Where
// whoever asked has a guard (base/memory.h), each thread has one of its own: where that is left no
// more pieces are given out, and once all threads have ended the guard of whoever asked is left.
#define _GNU_SOURCE // sched_getaffinity
#include "base/side_by_side.h"

#include "base/call.h"
#include "base/memory.h"

#include <pthread.h>
#include <sched.h>

// more threads than any machine at hand has processors to spare
enum { HELPERS_MOST = 63 };

typedef struct Work {
    const SideBySideTasks *tasks;
    pthread_mutex_t lock; // of whoever asks for a piece, or says that one has ended
    pthread_cond_t has_ended;
    Call *call; // that all is done for, or NULL
    bool is_guarded;
    bool is_left;        // a guard was
    const char *mistake; // why; NULL: for want of memory
} Work;

// One of the threads.
typedef struct Hand {
    Work *work;
    bool is_callers;
    volatile bool holds_lock;
} Hand;

size_t side_by_side_processors(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0) {
        return 1;
    }
    const int count = CPU_COUNT(&set);
    const size_t processors = count > 1 ? (size_t)count : 1;
    const Call *call = call_current();
    return call != NULL && call->threads > 0 && call->threads < processors ? call->threads
                                                                           : processors;
}

// The next piece, after a wait where that is needed; false where there is none. Holds the lock.
static bool find_piece(Work *work, size_t *index)
{
    const SideBySideTasks *tasks = work->tasks;
    if (work->is_left) {
        return false;
    }
    SideBySideNext next = tasks->next(index, tasks->context);
    while (next == SIDE_BY_SIDE_LATER) {
        pthread_cond_wait(&work->has_ended, &work->lock);
        if (work->is_left) {
            return false;
        }
        next = tasks->next(index, tasks->context);
    }
    return next == SIDE_BY_SIDE_PIECE;
}

// Does a piece without the lock, which it holds before and after.
static void do_piece(Hand *hand, size_t index)
{
    Work *work = hand->work;
    const SideBySideTasks *tasks = work->tasks;
    hand->holds_lock = false;
    pthread_mutex_unlock(&work->lock);
    tasks->work(index, hand->is_callers, tasks->context);
    pthread_mutex_lock(&work->lock);
    hand->holds_lock = true;
    if (tasks->end != NULL) {
        tasks->end(index, tasks->context);
    }
    pthread_cond_broadcast(&work->has_ended);
}

static void take_pieces(Hand *hand)
{
    size_t index;
    while (find_piece(hand->work, &index)) {
        do_piece(hand, index);
    }
}

// Takes pieces, under a guard of the thread's own where whoever asked has one.
static void take_guarded(Hand *hand, void (*take)(Hand *hand))
{
    Work *work = hand->work;
    if (!work->is_guarded) {
        take(hand);
        return;
    }
    MemoryGuard guard;
    memory_guard_begin(&guard);
    if (setjmp(guard.left) == 0) {
        take(hand);
    } else {
        if (!hand->holds_lock) {
            pthread_mutex_lock(&work->lock);
        }
        work->mistake = work->is_left ? work->mistake : guard.mistake;
        work->is_left = true;
        pthread_cond_broadcast(&work->has_ended);
    }
    memory_guard_end(&guard);
}

static void *help(void *context)
{
    Work *work = context;
    Hand hand = {.work = work, .holds_lock = true};
    call_set_current(work->call);
    if (work->call != NULL) {
        uselocale(work->call->locale);
    }
    pthread_mutex_lock(&work->lock);
    take_guarded(&hand, take_pieces);
    pthread_mutex_unlock(&work->lock);
    return NULL;
}

// Whoever asked, and the helpers.
typedef struct Crew {
    Hand hand; // first
    size_t threads;
    pthread_t helpers[HELPERS_MOST];
    volatile size_t helper_count;
} Crew;

// The first piece is the caller's, whoever is faster; helpers begin once there is one.
static void lead(Hand *hand)
{
    Crew *crew = (Crew *)hand;
    Work *work = hand->work;
    size_t first;
    if (!find_piece(work, &first)) {
        return;
    }
    while (crew->helper_count + 1 < crew->threads && crew->helper_count + 1 < work->tasks->most &&
           crew->helper_count < HELPERS_MOST &&
           pthread_create(&crew->helpers[crew->helper_count], NULL, help, work) == 0) {
        crew->helper_count++;
    }
    do_piece(hand, first);
    take_pieces(hand);
}

void side_by_side_tasks(const SideBySideTasks *tasks, size_t threads)
{
    Work work = {
        .tasks = tasks,
        .lock = PTHREAD_MUTEX_INITIALIZER,
        .has_ended = PTHREAD_COND_INITIALIZER,
        .call = call_current(),
        .is_guarded = memory_is_guarded(),
    };
    Crew crew = {.hand = {.work = &work, .is_callers = true, .holds_lock = true},
                 .threads = threads};
    pthread_mutex_lock(&work.lock);
    take_guarded(&crew.hand, lead);
    pthread_mutex_unlock(&work.lock);
    for (size_t i = 0; i < crew.helper_count; i++) {
        pthread_join(crew.helpers[i], NULL);
    }
    if (work.is_left) {
        memory_leave(work.mistake);
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

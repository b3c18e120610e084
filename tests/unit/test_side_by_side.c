// Is every piece of work done once, whatever the threads?
#include "close.h"

#include "base/side_by_side.h"

#include <pthread.h>
#include <stdatomic.h>

enum { PIECES = 1000, THREADS_MOST = 100 };

typedef struct Done {
    atomic_int times[PIECES];
    bool is_callers[PIECES];
    pthread_t threads[PIECES];
} Done;

static void note(size_t index, bool is_callers, void *context)
{
    Done *done = context;
    atomic_fetch_add(&done->times[index], 1);
    done->is_callers[index] = is_callers;
    done->threads[index] = pthread_self();
}

static void every_piece_is_done_once(void **state)
{
    (void)state;
    static const size_t THREADS[] = {0, 1, 2, 3, 64, THREADS_MOST};
    for (size_t i = 0; i < sizeof THREADS / sizeof *THREADS; i++) {
        Done done = {.is_callers = {false}};
        side_by_side_run(PIECES, THREADS[i], note, &done);
        for (size_t k = 0; k < PIECES; k++) {
            assert_int_equal(atomic_load(&done.times[k]), 1);
            assert_int_equal(done.is_callers[k], pthread_equal(done.threads[k], pthread_self()));
            assert_true(THREADS[i] > 1 || done.is_callers[k]);
        }
        assert_true(done.is_callers[0]);
    }
}

typedef struct Meeting {
    pthread_barrier_t barrier;
} Meeting;

static void meet(size_t index, bool is_callers, void *context)
{
    (void)index;
    (void)is_callers;
    pthread_barrier_wait(&((Meeting *)context)->barrier);
}

// Pieces that wait for each other would never end one after the other.
static void pieces_are_done_at_the_same_time(void **state)
{
    (void)state;
    Meeting meeting;
    pthread_barrier_init(&meeting.barrier, NULL, 3);
    side_by_side_run(3, 3, meet, &meeting);
    pthread_barrier_destroy(&meeting.barrier);
}

static void no_piece_is_no_work(void **state)
{
    (void)state;
    side_by_side_run(0, 4, note, NULL);
    assert_true(side_by_side_processors() >= 1);
}

// Pieces of a chain of stages: one of a stage can begin when all of the one before have ended.
enum { STAGES = 50, WIDTH = 3 };

typedef struct Stages {
    size_t begun; // pieces, in order
    size_t ended;
    atomic_int going[STAGES];
    atomic_bool is_mixed; // whether two stages went on at the same time
} Stages;

static SideBySideNext next_of_stages(size_t *index, void *context)
{
    Stages *stages = context;
    if (stages->begun == STAGES * WIDTH) {
        return SIDE_BY_SIDE_NONE;
    }
    if (stages->begun / WIDTH > stages->ended / WIDTH) {
        return SIDE_BY_SIDE_LATER;
    }
    *index = stages->begun++;
    return SIDE_BY_SIDE_PIECE;
}

static void do_one_of_stages(size_t index, bool is_callers, void *context)
{
    (void)is_callers;
    Stages *stages = context;
    const size_t stage = index / WIDTH;
    atomic_fetch_add(&stages->going[stage], 1);
    if ((stage > 0 && atomic_load(&stages->going[stage - 1]) > 0) ||
        (stage + 1 < STAGES && atomic_load(&stages->going[stage + 1]) > 0)) {
        atomic_store(&stages->is_mixed, true);
    }
    atomic_fetch_sub(&stages->going[stage], 1);
}

static void end_one_of_stages(size_t index, void *context)
{
    (void)index;
    ((Stages *)context)->ended++;
}

static void what_needs_others_waits_for_them(void **state)
{
    (void)state;
    for (size_t threads = 1; threads <= 4; threads++) {
        Stages stages = {.begun = 0};
        const SideBySideTasks tasks = {
            .most = WIDTH,
            .next = next_of_stages,
            .work = do_one_of_stages,
            .end = end_one_of_stages,
            .context = &stages,
        };
        side_by_side_tasks(&tasks, threads);
        assert_int_equal(stages.ended, STAGES * WIDTH);
        assert_false(atomic_load(&stages.is_mixed));
    }
}

// Two such chains are done as each by itself, and their pieces at the same time.
static void lists_do_not_wait_for_each_other(void **state)
{
    (void)state;
    for (size_t threads = 1; threads <= 4; threads++) {
        Stages stages[2] = {{.begun = 0}, {.begun = 0}};
        SideBySideTasks lists[2];
        for (int i = 0; i < 2; i++) {
            lists[i] = (SideBySideTasks){
                .most = WIDTH,
                .next = next_of_stages,
                .work = do_one_of_stages,
                .end = end_one_of_stages,
                .context = &stages[i],
            };
        }
        side_by_side_lists(lists, 2, threads);
        for (int i = 0; i < 2; i++) {
            assert_int_equal(stages[i].ended, STAGES * WIDTH);
            assert_false(atomic_load(&stages[i].is_mixed));
        }
    }
    side_by_side_lists(NULL, 0, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_piece_is_done_once),
        cmocka_unit_test(pieces_are_done_at_the_same_time),
        cmocka_unit_test(no_piece_is_no_work),
        cmocka_unit_test(what_needs_others_waits_for_them),
        cmocka_unit_test(lists_do_not_wait_for_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

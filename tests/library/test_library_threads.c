// May each thread step a world of its own, and does it get the numbers that one thread gets?
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <pthread.h>
#include <string.h>

enum { THREADS = 6, ROUNDS = 100, STEPS = 60 };

// What a thread does: a scene of a number, and where it ends.
typedef struct Task {
    int number;
    pthread_barrier_t *start;
    JpStatus status;
    double end;
} Task;

// Two arms on hinges, the first with stops, the second with backlash.
static JpStatus play(int number, double *end)
{
    dBodyID arms[2];
    dJointID hinges[2];
    dMass mass;
    JpWorld *world = NULL;
    JpJoint *joint = NULL;
    const dWorldID id = dWorldCreate();
    dMassSetBoxTotal(&mass, 1.0, 0.3, 0.02, 0.02);
    for (int i = 0; i < 2; i++) {
        arms[i] = dBodyCreate(id);
        dBodySetMass(arms[i], &mass);
        dBodySetPosition(arms[i], 0.15 + 0.3 * i, 0, 0);
        hinges[i] = dJointCreateHinge(id, 0);
        dJointAttach(hinges[i], arms[i], i == 0 ? 0 : arms[0]);
        dJointSetHingeAnchor(hinges[i], 0.3 * i, 0, 0);
        dJointSetHingeAxis(hinges[i], 0, 0, 1);
    }
    dWorldSetGravity(id, 0, -9.81 - number, 0);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = (JpStepping)(number % 3);
    JpStops stops = jp_stops_default();
    stops.low = -0.01;
    stops.contact.stiffness = 1e5;
    JpBacklash backlash = jp_backlash_default();
    backlash.gap = 0.01;
    backlash.tooth.stiffness = 1e4;
    JpStatus status = jp_world_create(id, &options, &world, NULL);
    status = status == JP_OK ? jp_stops_create(world, hinges[0], &stops, &joint, NULL) : status;
    status =
        status == JP_OK ? jp_backlash_create(world, hinges[1], &backlash, &joint, NULL) : status;
    for (int i = 0; i < STEPS && status <= JP_OK; i++) {
        status = jp_world_step(world, 1e-3, NULL);
    }
    status = status <= JP_OK ? JP_OK : status; // coarse steps have their numbers, too
    *end = dBodyGetPosition(arms[1])[1];
    jp_world_destroy(world);
    dWorldDestroy(id);
    return status;
}

static void *run(void *data)
{
    Task *task = data;
    dAllocateODEDataForThread(dAllocateMaskAll);
    pthread_barrier_wait(task->start);
    task->status = play(task->number, &task->end);
    dCleanupODEAllDataForThread();
    return NULL;
}

static void six_worlds_in_six_threads_give_the_numbers_of_one(void **state)
{
    (void)state;
    double alone[THREADS];
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(play(i, &alone[i]), JP_OK);
    }
    for (int round = 0; round < ROUNDS; round++) {
        pthread_barrier_t start;
        pthread_t threads[THREADS];
        Task tasks[THREADS];
        assert_int_equal(pthread_barrier_init(&start, NULL, THREADS), 0);
        for (int i = 0; i < THREADS; i++) {
            tasks[i] = (Task){.number = i, .start = &start};
            assert_int_equal(pthread_create(&threads[i], NULL, run, &tasks[i]), 0);
        }
        for (int i = 0; i < THREADS; i++) {
            assert_int_equal(pthread_join(threads[i], NULL), 0);
            assert_int_equal(tasks[i].status, JP_OK);
            assert_memory_equal(&tasks[i].end, &alone[i], sizeof alone[i]);
        }
        pthread_barrier_destroy(&start);
    }
    // the control: the scenes differ
    assert_true(alone[0] != alone[3]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(six_worlds_in_six_threads_give_the_numbers_of_one),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}

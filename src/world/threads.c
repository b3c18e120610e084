// Chooses who does the work of a step.
//
// Not several threads: ODE's self-threaded implementation does all in the thread that waits for it.
#include "world/threads.h"

#include "world/fault.h"

static void give(JpWorld *world)
{
    world->threading = dThreadingAllocateSelfThreadedImplementation();
    if (world->threading != NULL) {
        dWorldSetStepThreadingImplementation(
            world->id, dThreadingImplementationGetFunctions(world->threading), world->threading);
    }
}

void threads_begin(JpWorld *world)
{
    if (!world->options.keeps_threading) {
        give(world);
    }
}

void threads_end(JpWorld *world)
{
    if (world->threading != NULL) {
        dWorldSetStepThreadingImplementation(world->id, NULL, NULL);
        dThreadingFreeImplementation(world->threading);
    }
}

// Where ODE has no memory for another one the world gets ODE's default.
void threads_renew(JpWorld *world)
{
    if (world->threading == NULL) {
        return;
    }
    Fault fault;
    fault_begin(&fault);
    if (setjmp(fault.left) == 0) {
        give(world);
    } else {
        world->threading = NULL;
    }
    fault_end(&fault);
    if (world->threading == NULL) {
        dWorldSetStepThreadingImplementation(world->id, NULL, NULL);
    }
    dWorldCleanupWorkingMemory(world->id);
}

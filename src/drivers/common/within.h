// What drivers share whose contacts are integrated within the engine's steps, by the contact
// kernel.
#pragma once

#include "drivers/common/driver.h"
#include "kernel/kernel.h"

// Adds the pins in holes of a case to a kernel, as contacts with plain rows, and makes room in it.
// Writes the number of the joint of each contact. Refuses a case without any.
void within_add_contacts(const DriverCase *of, Kernel *kernel, size_t *joints);

// How all bodies move at a time since the start of the step, s, from the kernel's sums there.
typedef void (*WithinMotions)(void *adapter, double since_s, const KernelSums *sums,
                              DriverMotion *motions);

// A step that the kernel has integrated.
typedef struct WithinStep {
    const Kernel *kernel;
    const size_t *joints;  // by contact
    DriverContact *states; // by joint: whether it touched at the step's start
    double start_s;
    double step_s;
    WithinMotions motions;
    void *adapter;
    DriverMotion *room; // by body
    KernelSums *sums;   // likewise room
} WithinStep;

// Makes the samples in the step, the records of its parts, from node to node, and the totals.
void within_look(const WithinStep *step, DriverRun *run);

// How a world of ODE does the pieces of its steps: one after the other, in the thread that steps
// it.
//
// ODE's own way of doing so goes through locks, pools and atomic counts that are there for threads,
// a fortieth of a small step, and worlds share it. Each world here has its own: worlds may be
// stepped in different threads, and a step that was left by a jump leaves nothing behind.
#pragma once

#include <ode/ode.h>

typedef struct Jobs Jobs;

// Makes a world do its steps so. To be freed after the world is destroyed.
Jobs *jobs_make(dWorldID world);

// Accepts NULL.
void jobs_free(Jobs *jobs);

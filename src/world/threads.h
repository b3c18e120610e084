// Threads: each world steps by itself in the thread that calls.
#pragma once

#include "world/play.h"

// Gives ODE's world a threading implementation of its own; takes it away again. ODE's default is
// one for all worlds of the process, which two threads must not use at a time.
void threads_begin(JpWorld *world);
void threads_end(JpWorld *world);

// The same anew after a step that ODE broke off: what it had under way is not taken up again. The
// implementation that held it is lost, some kilobytes.
void threads_renew(JpWorld *world);

// Lanes in which one process works at a time and the next stands ready behind it, so that no core
// waits for a process to be ended, its result to be kept, and another one to be started.
//
// Whoever works holds a lock of its own, which the system takes back should it die.
#pragma once

#include <stddef.h>

// The lanes, as a file descriptor; -1 where the system has none: everybody then works at once.
int lane_open(void);
void lane_close(int lanes);

// In a child: waits until whoever worked in that lane is done, and works from then on, so many
// seconds of wall time at most (0: no limit); beyond them SIGALRM ends it.
void lane_enter(int lanes, size_t lane, double limit_s);

// In a child: its work is done.
void lane_leave(int lanes, size_t lane);

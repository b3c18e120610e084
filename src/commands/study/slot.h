// Worker slots: in each one process works while the next one waits, so that no core is idle while a
// process ends, its result is stored, and another one is started.
//
// The process that works holds a lock, which the system releases should it die.
#pragma once

#include <stddef.h>

// The slots, as a file descriptor; -1 where the system has none: all processes then work at once.
int slot_open(void);
void slot_close(int slots);

// In a child: waits until the process in that slot is done, then takes the slot, for at most
// `limit_s` of wall time (0: no limit), after which SIGALRM ends it.
void slot_enter(int slots, size_t slot, double limit_s);

// In a child: releases the slot.
void slot_leave(int slots, size_t slot);

// Worker slots, and what a process writes before it dies.
#pragma once

#include <stddef.h>

// Worker slots: in each one process works while the next one waits, so that no core is idle while a
// process ends, its result is stored, and another one is started.
//
// The process that works holds a lock, which the system releases should it die.

// The slots, as a file descriptor; -1 where the system has none: all processes then work at once.
int slot_open(void);
void slot_close(int slots);

// In a child: waits until the process in that slot is done, then takes the slot, for at most
// `limit_s` of wall time (0: no limit), after which SIGALRM ends it.
void slot_enter(int slots, size_t slot, double limit_s);

// In a child: lets its limit begin anew.
void slot_limit_again(double limit_s);

// In a child: releases the slot.
void slot_leave(int slots, size_t slot);

// What a child writes on standard output and error before it dies, kept off the terminal.

// A file in memory for the output of one child at a time, as a descriptor; -1 where the system has
// none, which the functions below accept: the output is then lost.
int last_words_open(void);
void last_words_close(int file);

// Empties it, before a child is started.
void last_words_clear(int file);

// In the child: sends standard output and error there. Output beyond a limit is dropped.
void last_words_listen(int file);

// The last line that is not empty, shortened to `size`; empty where there is none.
void last_words_read(int file, char *line, size_t size);

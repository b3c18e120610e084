// What a process says on standard output and error before it dies, kept off the terminal.
#pragma once

#include <stddef.h>

// A place in memory for the words of one child at a time, as a file descriptor; -1 where the system
// has none, which the rest accepts: the words are then lost.
int last_words_open(void);
void last_words_close(int place);

// Forgets what stands there; before a child is started.
void last_words_clear(int place);

// In the child: standard output and error go there from now on. What is too much of it is dropped.
void last_words_listen(int place);

// The last line that is not empty, cut to so many bytes; empty where there is none.
void last_words_read(int place, char *line, size_t size);

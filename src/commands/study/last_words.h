// What a child writes on standard output and error before it dies, kept off the terminal.
#pragma once

#include <stddef.h>

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

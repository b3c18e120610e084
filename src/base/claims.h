// The files that this command reads and those that it is going to write, so that no file is both
// and none is written twice.
//
// Whatever opens a file notes it here. It is the one thing that the whole process shares: which
// files a command uses is known where they are opened, and asked where others are written.
#pragma once

#include <stdbool.h>

// What the path leads to, as a message names it.
typedef struct Claim {
    const char *user; // who reads it ("case") or writes it ("--plot"); not the caller's
    bool is_read;
} Claim;

// Notes a file that is read, or one that will be written; "-" is standard output. Any other pipe,
// terminal or device may be used by as many as like.
void claims_note_read(const char *user, const char *path);
void claims_note_written(const char *user, const char *path);

// Whether somebody reads or writes the file that a path leads to, whatever the spelling: by links,
// hard ones too, and for one that is not there yet, by its folder. A reader is named before a
// writer.
bool claims_find(const char *path, Claim *claim);

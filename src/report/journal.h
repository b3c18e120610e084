// The store of a comparison: a file with a line of JSON for each run that is over, in which a
// comparison that was ended at any moment finds again all that it had.
//
// The first line holds the key: what must be equal for a run of then to be one of now. A line is
// written at once and on the disk before the next run begins; a last line that was cut short is
// dropped.
#pragma once

#include "base/err.h"

#include <jansson.h>

typedef struct Journal {
    int file; // open and locked
    char *path;
    json_t *entries; // owned: the lines behind the first
} Journal;

// Opens the store, or makes it where there is none, or makes it anew where `is_fresh`. Fails with
// ERR_FILE where it cannot be read or written, is at work in another process, is no store, or
// holds another key: it then says what differs. Only a store is ever made anew.
bool journal_open(Journal *journal, const char *path, json_t *key, bool is_fresh, Err *err);

// Writes one line and sees it to the disk; takes the reference. ERR_FILE.
bool journal_add(Journal *journal, json_t *entry, Err *err);

// Accepts a zeroed journal.
void journal_close(Journal *journal);

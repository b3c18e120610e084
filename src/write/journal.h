// The store of a comparison, or of a baseline in the making: a file with a line of JSON for each
// run that is over, in which a command that was ended at any moment finds again all that it had.
//
// The first line holds the key: what must be equal for a run of then to be one of now. A line is
// written at once and on the disk before the next run begins; a last line that was cut short is
// dropped. Each line ends with a checksum of itself; one that is not what was once written is not
// used, and its run is made again.
#pragma once

#include "base/err.h"
#include "base/text.h"

#include <jansson.h>

// Whose store it is, and how messages call it.
typedef struct JournalKind {
    const char *name;   // the command; the key of the first line
    const char *what;   // the file is: "store"
    const char *work;   // it belongs to: "comparison"
    const char *remedy; // for one that cannot be gone on with, behind a message
} JournalKind;

extern const JournalKind JOURNAL_COMPARE;
extern const JournalKind JOURNAL_BLESS;

typedef struct Journal {
    const JournalKind *kind;
    int file; // open and locked
    char *path;
    json_t *entries; // owned: the lines behind the first; null where a line is damaged
    size_t damaged_count;
    size_t damaged_line; // number of the first that is
} Journal;

// Opens the store, or creates it where there is none, or creates it again where `is_fresh`. Fails
// with ERR_FILE where it cannot be read or written, is in use by another process, is no store, has
// a damaged first line, or holds another key: it then says what differs. Only a store is ever made
// created again.
bool journal_open(Journal *journal, const JournalKind *kind, const char *path, json_t *key,
                  bool is_fresh, Err *err);

// What to say of damaged lines; empty where there are none.
void journal_describe_damage(const Journal *journal, Text *text);

// Writes one line and sees it to the disk; takes the reference. ERR_FILE.
bool journal_add(Journal *journal, json_t *entry, Err *err);

// Deletes the file, which is no longer needed, and closes it. Accepts a zeroed journal.
void journal_discard(Journal *journal);

// Accepts a zeroed journal.
void journal_close(Journal *journal);

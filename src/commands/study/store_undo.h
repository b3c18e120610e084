// What a store held before a write that was interrupted, found without writing to it.
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct UndoPage {
    uint32_t number; // from 1
    off_t offset;    // of its former content in the journal
} UndoPage;

// Zeroed: there is nothing to undo.
typedef struct Undo {
    bool is_needed;
    int journal; // open where it is needed
    off_t journal_size;
    uint32_t page_size;
    uint32_t page_count; // of the file before the write
    size_t count;
    size_t room;
    UndoPage *pages; // owned; by rising number
} Undo;

// Reads the journal of that path. A missing or empty one undoes nothing. False where it cannot be
// read.
bool undo_read(Undo *undo, const char *path);

// The offset in the journal of a page as it was; -1 where the write has not changed it.
off_t undo_find(const Undo *undo, uint32_t number);

// Accepts a zeroed one.
void undo_finish(Undo *undo);

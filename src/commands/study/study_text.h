// What `jointplay study status` prints for people.
#pragma once

#include "base/text.h"
#include "commands/study/store.h"
#include "write/style.h"

// A store, and how much of its study it is to hold.
typedef struct StudyPart {
    const char *path;
    Store *store;    // being viewed; NULL: nothing is there yet
    uint64_t wanted; // runs it is to hold in the end
} StudyPart;

// How far the parts of one study have come: runs that are over, what became of them, the most
// frequent reasons with an example of each, the time they took and what is left. Fails with
// ERR_FILE.
bool study_text_status(const StudyPart *parts, size_t part_count, const Style *style, Text *text,
                       Err *err);

// The distribution of each result over the runs that went well: least, 5 %, median, 95 %, most.
// Fails with ERR_FILE.
bool study_text_summary(Store *store, const Style *style, Text *text, Err *err);

// A file is written whole or not at all.
//
// The text goes to a file beside the target and takes the target's name only when all of it has
// been written, so that a full disk or a killed program never leaves half a file. A target that is
// no regular file (a pipe, a terminal, /dev/full) is written to directly.
#pragma once

#include "base/err.h"
#include "base/sink.h"

#include <stdio.h>

enum { FILE_PATH_SIZE = 4096 };

// A file that is being written; write to `stream` in between. Not to be copied.
typedef struct WholeFile {
    FILE *stream;
    Sink sink;
    char path[FILE_PATH_SIZE];      // the target
    char temporary[FILE_PATH_SIZE]; // beside it; empty where the target is written directly
} WholeFile;

// Whether a path stands for a stream that is written as it is: "-" and /dev/stdout for standard
// output, a pipe, a device. Anything else is a file that is written whole or not at all.
bool file_is_stream(const char *path);

// Whether two paths, neither of which must exist, lead to the same file. NULL leads nowhere.
bool file_is_same(const char *path, const char *other);

// Whether a file can be written there, before the work whose result it is to hold. Leaves nothing
// behind. Fails as file_begin would.
bool file_probe(const char *path, Err *err);

// Begins a file. One that replaces another keeps its mode; what processes that were killed have
// left half-written of it is taken away. Fails with ERR_FILE, naming the path and the reason; the
// text is empty, as it is for all that follow, where it is a pipe whose reader has gone away.
bool file_begin(WholeFile *file, const char *path, Err *err);

// Whether all could be written so far, so that a full disk is not written to for ever. ERR_FILE.
bool file_check(const WholeFile *file, Err *err);

// Ends the file: it now stands under its name. Where anything could not be written since
// file_begin it fails with ERR_FILE, and nothing of it is left.
bool file_end(WholeFile *file, Err *err);

// Gives the file up: nothing of it is left.
void file_abandon(WholeFile *file);

// All of the above for text that is ready.
bool file_write_text(const char *path, const char *text, Err *err);

// A file is written whole or not at all.
//
// The text goes to a file beside the target and takes the target's name only when all of it has
// been written, so that a full disk or a killed program never leaves half a file. A target that is
// no regular file (a pipe, a terminal, /dev/full) is written to directly.
//
// And it replaces nothing but its own: no file that the command reads, and none of another kind
// (file_kind.h). Who wants that deletes the file first.
#pragma once

#include "base/err.h"
#include "write/file_kind.h"
#include "write/sink.h"

#include <stdio.h>

enum { FILE_PATH_SIZE = 4096 };

// A file that is being written; write to `stream` in between. Not to be copied.
typedef struct WholeFile {
    FILE *stream;
    Sink sink;
    char path[FILE_PATH_SIZE];      // the target
    char temporary[FILE_PATH_SIZE]; // beside it; empty where the target is written directly
} WholeFile;

// Whether a path stands for a stream that is written as it is: "-" for standard output,
// /dev/stdout, /dev/stderr and /dev/fd/N for what the caller opened, a pipe, a device. Anything
// else is a file that is written whole or not at all.
bool file_is_stream(const char *path);

// Claims a file for an output of this command, before the work whose result it is to hold: `user`
// is what the message calls the output, an option such as "--plot". Fails with ERR_USAGE where the
// command reads that file or has another output for it, with ERR_FILE where what is there is of
// another kind, or where it cannot be written. Leaves nothing behind.
bool file_claim(const char *user, FileKind kind, const char *path, Err *err);

// Whether the command does not read that file, which is to be the name of an output or the
// beginning of its name. ERR_USAGE.
bool file_check_input(const char *user, const char *path, Err *err);

// Begins a file. One that replaces another keeps its mode; what processes that were killed have
// left half-written of it is taken away. Fails as file_claim does, whether it was claimed or not,
// so that nothing of another kind is ever replaced; the text is empty, as it is for all that
// follow, where it is a pipe whose reader has gone away.
bool file_begin(WholeFile *file, FileKind kind, const char *path, Err *err);

// Whether all could be written so far, so that a full disk is not written to for ever. ERR_FILE.
bool file_check(const WholeFile *file, Err *err);

// Ends the file: it now stands under its name. Where anything could not be written since
// file_begin it fails with ERR_FILE, and nothing of it is left.
bool file_end(WholeFile *file, Err *err);

// Gives the file up: nothing of it is left.
void file_abandon(WholeFile *file);

// All of the above for text that is ready.
bool file_write_text(FileKind kind, const char *path, const char *text, Err *err);

// Takes a file of this kind away where one is there; what is of another kind stays.
void file_remove(FileKind kind, const char *path);

// Makes the folder, and those it stands in, where they are missing. ERR_FILE.
bool file_make_folder(const char *folder, Err *err);

// The name of a file without its folder and its ending: "k66" of "cases/k66.yaml".
void file_stem(const char *path, char *name, size_t size);

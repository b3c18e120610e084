// A file is written whole or not at all.
//
// The text goes to a file beside the target and takes the target's name only when all of it has
// been written, so that a full disk or a killed program never leaves half a file. A target that is
// no regular file (a pipe, a terminal, /dev/full) is written to directly.
//
// And it replaces nothing but its own: no file that the command reads, and none of another kind
// (FileKind). Who wants that deletes the file first.
#pragma once

#include "base/err.h"

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

// What a file of the program is, known again by how it begins: a file is only replaced by one of
// its own kind. Every writer says which kind it writes; a new one is a row of the table.

typedef enum FileKind {
    FILE_TABLE,    // CSV
    FILE_PICTURE,  // SVG
    FILE_RESULT,   // JSON
    FILE_REPORT,   // text for people
    FILE_PAGE,     // of report: HTML
    FILE_CODE,     // of tune: a C program
    FILE_SDF,      // of tune, for Gazebo
    FILE_MJCF,     // of tune, for MuJoCo
    FILE_JUNIT,    // of check: XML
    FILE_COMMENT,  // of check: Markdown
    FILE_BASELINE, // of check: JSON
    FILE_ROWS,     // JSON Lines
    FILE_CASE,     // of new: YAML
    FILE_SCRIPT,   // of a study, for Slurm
    FILE_STORE,    // of a study: SQLite, written in place
    FILE_JOURNAL,  // of a comparison: JSON Lines, written in place
    FILE_KIND_COUNT,
} FileKind;

// A stream into a file descriptor that remembers why a write failed: stdio keeps only that one did.

typedef struct Sink {
    int file;
    int reason; // errno of the first write that failed; 0 where none did
} Sink;

// A stream into an open file. Closing the stream closes the file; the sink must outlive both. What
// comes after a write that failed is dropped. NULL, with errno set, where there is no memory.
FILE *sink_open(Sink *sink, int file);

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

// Takes away what is half-written, for a handler that ends the process; allocates nothing.
void file_take_away_pending(void);

// All of the above for text that is ready.
bool file_write_text(FileKind kind, const char *path, const char *text, Err *err);

// Takes a file of this kind away where one is there; what is of another kind stays.
void file_remove(FileKind kind, const char *path);

// Makes the folder, and those it stands in, where they are missing. ERR_FILE.
bool file_make_folder(const char *folder, Err *err);

// The name of a file without its folder and its ending: "k66" of "cases/k66.yaml".
void file_stem(const char *path, char *name, size_t size);

// A lock that says "somebody works on this file", from opening to closing.
//
// It hangs on the open file and not on the process: other code of the process that opens and closes
// the file does not end it. Children inherit it, and die with their parent, but only just after it:
// so it is waited for, for a moment, and given up explicitly.

// Takes the lock on one byte of a file open for writing. Returns 0, EAGAIN where another process
// has it, or the errno of what went wrong.
int work_lock_take(int file, off_t byte);

void work_lock_give(int file, off_t byte);

// Whether anybody has it. Accepts a file that is not open (-1).
bool work_lock_is_taken(int file, off_t byte);

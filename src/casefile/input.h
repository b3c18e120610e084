// Reading a case file or another one of its kind as a whole, and refusing what cannot be one.
//
// `what` it is stands in messages: "case", "study".
#pragma once

#include "casefile/document.h"

#define INPUT_STDIN "stdin" // what messages and reports call standard input

enum { INPUT_SIZE_MAX = 16 << 20 }; // bytes; a case has some thousand, 20,000 four-bars 12 MiB

// Reads the file, or the one of that path or name that came with the program, into *text (owned by
// the caller, ends in a zero). Fails with ERR_FILE where it is missing or unreadable, and with
// ERR_CASE where it is a directory or larger than INPUT_SIZE_MAX; the outputs are then untouched.
bool input_read(const char *what, const char *path, char **text, size_t *size, Err *err);

// The same from standard input, which may be asked for again: what a pipe held is kept in memory.
bool input_read_stdin(const char *what, char **text, size_t *size, Err *err);

// Whether a file can be read and is a study: it names a case and describes no mechanism.
bool input_is_study(const char *path);

// Parses a text into a tree that the caller destroys; the source, which borrows name and text, says
// where its nodes stand. Fails with ERR_CASE where it is no text (empty, not valid UTF-8, with
// control characters), no YAML, or holds no document, and with ERR_USAGE where a study was given
// for a case or a case for a study; *root is then untouched.
bool input_parse(const char *what, const char *name, const char *text, size_t size, Source *source,
                 Node **root, Err *err);

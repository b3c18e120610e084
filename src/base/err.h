// One error, reported once: what went wrong, in one sentence, and the exit status it leads to.
//
// What the user, the data or a solver can cause is reported through an Err; what only the program
// itself can cause is an assert. The first error wins: a later err_set on the same Err is ignored.
#pragma once

#include <stdbool.h>

enum { ERR_TEXT_SIZE = 2048 };

// The kind of an error is the exit status of the program.
typedef enum ErrKind {
    ERR_NONE = 0,    // no error
    ERR_DIFFERS = 1, // the numbers differ from what was expected
    ERR_USAGE = 2,   // the command line is wrong
    ERR_CASE = 3,    // the case file is wrong
    ERR_SOLVER = 4,  // a solver failed
    ERR_FILE = 5,    // a file could not be read or written
} ErrKind;

typedef struct Err {
    ErrKind kind;
    char text[ERR_TEXT_SIZE]; // one sentence, or several lines where a caret points at a place
} Err;

// Sets the error if none is set yet. Always returns false, so that a function can
// `return err_set(err, ...)`. A text too long for the buffer is shortened to whole words. Arguments
// may hold anything, such as a path: what cannot be shown of them is escaped, line breaks too.
bool err_set(Err *err, ErrKind kind, const char *format, ...) __attribute__((format(printf, 3, 4)));

// The same of a text that has its lines already, such as that of another error.
bool err_set_lines(Err *err, ErrKind kind, const char *lines);

// Adds another error on lines of its own below one that is set; of both kinds the graver, which has
// the larger number, stays. Always returns false.
bool err_add(Err *err, const Err *further);

// Puts "prefix: " in front of the text of an error that is set.
void err_prefix(Err *err, const char *prefix);

// A text that a case is read from, and messages that point into it.
#pragma once

#include "base/err.h"

#include <stdarg.h>
#include <stddef.h>

// A stretch of a text, in characters from its start (not bytes); `end` stands behind the last.
typedef struct Span {
    size_t start;
    size_t end;
} Span;

// Borrows name and text, which must outlive it.
typedef struct Source {
    const char *name; // as messages print it: a file's path, or the option
    const char *text; // valid UTF-8
    size_t size;      // bytes
    size_t shift;     // characters in front of the part that spans count from (the key of --set)
    const char *what; // it is, where a document is parsed from it: "case", "study"
    bool is_option;   // given on the command line: messages name no line and are ERR_USAGE
    bool is_override; // it says other than a case did: messages point at it first
} Source;

// Sets the error to the sentence, with its place in front, and below it the line, a caret with a
// tail under the span, and "allowed: ..." where `allowed` is neither NULL nor empty. False always.
bool source_error(const Source *source, Span span, const char *allowed, Err *err,
                  const char *format, ...) __attribute__((format(printf, 5, 6)));

// The same, with what would be allowed in the format: "the step is too long\nallowed: 1 s or less".
bool source_refuse(const Source *source, Span span, Err *err, const char *format, va_list arguments)
    __attribute__((format(printf, 4, 0)));

// Bytes at the start of the text that are valid UTF-8 without control characters other than tabs
// and line breaks; equal to size where all of it is text.
size_t source_text_length(const char *text, size_t size);

// Whether all of a text of `size` bytes, ended by 0, is text without tabs and line breaks.
bool source_is_one_line(const char *text, size_t size);

// The number of characters in `size` bytes of text.
size_t source_count(const char *text, size_t size);

// The line, counted from 1, that a character stands on.
size_t source_line(const Source *source, size_t character);

// How far lines have been counted: zeroed at first.
typedef struct SourceCount {
    const Source *source;
    size_t character;
    size_t byte;
    size_t breaks; // before it
} SourceCount;

// The same for one character after the other: goes on from the last one where that stands before
// it in the same text.
size_t source_line_next(SourceCount *count, const Source *source, size_t character);

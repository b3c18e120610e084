// Text of a user's as it can be shown: a path, a name or a message may hold anything.
//
// What a terminal, a log or an editor would obey or hide is shown as an escape: controls (\n, \x1b,
// \u0085), marks that turn the direction of writing, line and paragraph separators and characters
// without a picture (\u202e), and bytes that are not UTF-8 (\xff). A backslash stays as it is.
#pragma once

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

enum { PRINTABLE_ESCAPE_SIZE = 12 };

// A character of a text that ends in a zero.
typedef struct PrintableCharacter {
    size_t size;                        // bytes, at least 1
    bool is_text;                       // false: no UTF-8
    unsigned code;                      // of a character, or the byte that is none
    char escape[PRINTABLE_ESCAPE_SIZE]; // empty where it is shown as it is
} PrintableCharacter;

// The character at the start of a text, which has at least so many bytes.
PrintableCharacter printable_character(const char *text, size_t size);

// Whether all of a text is shown as it is.
bool printable_is_shown(const char *text);

// A text with its escapes; the caller frees it. With `keeps_lines` line breaks stay.
char *printable_copy(const char *text, bool keeps_lines);

// Puts a text together as vsnprintf does, with escapes for all that its arguments bring in: only
// the line breaks of the format itself stay. The caller frees it.
char *printable_format(const char *format, va_list arguments) __attribute__((format(printf, 1, 0)));

// Copies a sentence into a fixed buffer. One that is too long ends behind a whole word, with "
// ...", and within a word only where that word takes up most of the buffer.
void shorten_copy(char *target, size_t size, const char *source);

// The same of a sentence that is still to be put together. What cannot be shown of its arguments is
// escaped, see above; line breaks of the format stay.
void shorten_list(char *target, size_t size, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

// Growing text, and the small questions about words that messages need.
#pragma once

#include <stdarg.h>
#include <stddef.h>

typedef struct Text {
    char *data; // ends in a zero; never NULL after text_init
    size_t length;
    size_t capacity;
} Text;

void text_init(Text *text);
void text_finish(Text *text);
void text_append(Text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
void text_append_list(Text *text, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));

// Appends bytes as they are.
void text_append_bytes(Text *text, const char *bytes, size_t count);

// Appends a path or another text of a user's as it can be shown on one line, see base/printable.h.
void text_append_shown(Text *text, const char *words);

// Escapes all that cannot be shown of a text, but for its line breaks and for these marks, which
// end in NULL: what colours a terminal. Empty ones are no marks.
void text_show(Text *text, const char *const *marks);

// The shortest decimal that reads back as the same number, which is finite.
void text_append_number(Text *text, double value);

// The characters of so many bytes of UTF-8, without what only colours a terminal.
size_t text_width(const char *text, size_t size);

// Breaks every line that is longer than so many characters between its words; 0 breaks none. What
// follows stands under the line's own beginning, and of "  name   words" under the words. Rows of
// tables, and lines that are indented by four and more, which are code or quote a file, stay as
// they are; so does a word that is too long for any line.
void text_fold(Text *text, size_t width);

// The same of what stands behind so many bytes alone.
void text_fold_behind(Text *text, size_t start, size_t width);

// Copies a name into a fixed buffer, cut if it is too long.
void text_copy(char *target, size_t size, const char *source);

// The smallest number of insertions, deletions, replacements and swaps of neighbours that turn
// one word into the other.
size_t text_distance(const char *a, const char *b);

// The choice nearest to the word, or NULL where none is near enough to be meant
// (at most a third of the word's letters differ, or of three letters it lacks one, or it begins
// with the word).
const char *text_nearest(const char *word, const char *const *choices, size_t count);

// Sentences in buffers that may be too small for them.
#pragma once

#include <stdarg.h>
#include <stddef.h>

// Copies a sentence into a fixed buffer. One that is too long ends behind a whole word, with "
// ...", and within a word only where that word takes up most of the buffer.
void shorten_copy(char *target, size_t size, const char *source);

// The same of a sentence that is still to be put together. What cannot be shown of its arguments is
// escaped, see base/printable.h; line breaks of the format stay.
void shorten_list(char *target, size_t size, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

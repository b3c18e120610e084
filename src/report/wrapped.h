// Words for people in lines of at most 80 columns.
#pragma once

#include "base/text.h"

// Appends a key in a column of its own and its words beside it, broken at spaces, and ends the
// line. A word that is longer than a line stands alone on one.
void wrapped_entry(Text *text, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// The same without a key, from the left: a paragraph, indented by two spaces.
void wrapped_words(Text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

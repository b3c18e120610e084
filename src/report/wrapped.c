// Where do lines of words break?
#include "report/wrapped.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum {
    WIDTH = 80,      // columns of a terminal that nobody has changed
    KEY_INDENT = 14, // two spaces, the key, and what separates it from the words
    WORD_INDENT = 2,
    WORDS_SIZE = 4096,
};

// Appends words from a column on; further lines begin at the indent.
static void append_words(Text *text, size_t column, size_t indent, const char *words)
{
    bool is_first = true;
    while (*words != '\0') {
        const size_t length = strcspn(words, " ");
        if (!is_first && column + 1 + length > WIDTH) {
            text_append(text, "\n%*s", (int)indent, "");
            column = indent;
        } else if (!is_first) {
            text_append(text, " ");
            column++;
        }
        text_append(text, "%.*s", (int)length, words);
        column += length;
        words += length;
        words += strspn(words, " ");
        is_first = false;
    }
    text_append(text, "\n");
}

void wrapped_entry(Text *text, const char *key, const char *format, ...)
{
    char words[WORDS_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    text_append(text, "  %-*s", KEY_INDENT - 2, key);
    append_words(text, KEY_INDENT, KEY_INDENT, words);
}

void wrapped_words(Text *text, const char *format, ...)
{
    char words[WORDS_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    text_append(text, "  ");
    append_words(text, WORD_INDENT, WORD_INDENT, words);
}

// How does a sentence that is too long for its buffer end?
#include "base/shorten.h"

#include "base/printable.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char MORE[] = " ...";

void shorten_copy(char *target, size_t size, const char *source)
{
    if (strlen(source) < size || size <= sizeof MORE) {
        snprintf(target, size, "%s", source);
        return;
    }
    const size_t room = size - sizeof MORE;
    size_t length = room;
    while (length > 0 && source[length] != ' ') {
        length--;
    }
    if (length < room / 2) {
        // between two characters, which may have several bytes
        length = room;
        while (length > 0 && ((unsigned char)source[length] & 0xc0u) == 0x80u) {
            length--;
        }
    }
    snprintf(target, size, "%.*s%s", (int)length, source, MORE);
}

void shorten_list(char *target, size_t size, const char *format, va_list arguments)
{
    char *text = printable_format(format, arguments);
    shorten_copy(target, size, text);
    free(text);
}

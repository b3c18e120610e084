// Writes words in XML.
#include "write/xml.h"
#include "base/printable.h"

#include <stdlib.h>
#include <string.h>

void xml_append(const char *words, Text *text)
{
    char *shown = printable_copy(words, true);
    for (const char *c = shown; *c != '\0'; c++) {
        switch (*c) {
        case '&':
            text_append(text, "&amp;");
            break;
        case '<':
            text_append(text, "&lt;");
            break;
        case '>':
            text_append(text, "&gt;");
            break;
        case '"':
            text_append(text, "&quot;");
            break;
        case '\n':
            text_append(text, "&#10;");
            break;
        default:
            text_append(text, "%c", *c);
        }
    }
    free(shown);
}

void xml_append_element(const char *tag, const char *lines, Text *text)
{
    text_append(text, "<%s>\n", tag);
    while (*lines != '\0') {
        const size_t length = strcspn(lines, "\n");
        text_append(text, "  %.*s\n", (int)length, lines);
        lines += length + (lines[length] == '\n' ? 1 : 0);
    }
    text_append(text, "</%.*s>\n", (int)strcspn(tag, " "), tag);
}

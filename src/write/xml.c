// How do words stand in XML?
#include "write/xml.h"

#include "base/printable.h"

#include <stdlib.h>

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

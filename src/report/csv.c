// How do words stay in their cell?
#include "report/csv.h"

#include <string.h>

void csv_write_quoted(FILE *stream, const char *text)
{
    fputc('"', stream);
    for (; *text != '\0'; text++) {
        fputs(*text == '"' ? "\"" : "", stream);
        fputc(*text == '\n' ? ' ' : *text, stream);
    }
    fputc('"', stream);
}

void csv_write_word(FILE *stream, const char *text)
{
    if (strpbrk(text, ",\"\n\r") != NULL) {
        csv_write_quoted(stream, text);
    } else {
        fputs(text, stream);
    }
}

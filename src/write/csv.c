// Writes words and numbers as cells of CSV.
#include "write/csv.h"
#include "base/printable.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void write_quoted(FILE *stream, const char *shown)
{
    fputc('"', stream);
    for (; *shown != '\0'; shown++) {
        fputs(*shown == '"' ? "\"" : "", stream);
        fputc(*shown == '\n' ? ' ' : *shown, stream);
    }
    fputc('"', stream);
}

void csv_write_quoted(FILE *stream, const char *text)
{
    char *shown = printable_copy(text, true);
    write_quoted(stream, shown);
    free(shown);
}

void csv_write_word(FILE *stream, const char *text)
{
    char *shown = printable_copy(text, true);
    if (strpbrk(shown, ",\"\n") != NULL) {
        write_quoted(stream, shown);
    } else {
        fputs(shown, stream);
    }
    free(shown);
}

void csv_write_number(FILE *stream, double value)
{
    if (isfinite(value)) {
        fprintf(stream, "%.17g", value);
    }
}

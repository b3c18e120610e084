// Carries an error to the one place that prints it.
#include "base/err.h"

#include "base/printable.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool err_set(Err *err, ErrKind kind, const char *format, ...)
{
    if (err->kind != ERR_NONE) {
        return false;
    }
    err->kind = kind;
    va_list arguments;
    va_start(arguments, format);
    shorten_list(err->text, sizeof err->text, format, arguments);
    va_end(arguments);
    return false;
}

// Whole lines that are put together already.
static void take_lines(Err *err, char *lines)
{
    shorten_copy(err->text, sizeof err->text, lines);
    free(lines);
}

bool err_set_lines(Err *err, ErrKind kind, const char *lines)
{
    if (err->kind == ERR_NONE) {
        err->kind = kind;
        take_lines(err, printable_copy(lines, true));
    }
    return false;
}

bool err_add(Err *err, const Err *further)
{
    if (err->kind == ERR_NONE || further->kind == ERR_NONE) {
        return err_set_lines(err, further->kind, further->text);
    }
    err->kind = further->kind > err->kind ? further->kind : err->kind;
    char *lines = malloc(strlen(err->text) + strlen(further->text) + sizeof "\n");
    assert(lines != NULL);
    sprintf(lines, "%s\n%s", err->text, further->text);
    take_lines(err, lines);
    return false;
}

void err_prefix(Err *err, const char *prefix)
{
    if (err->kind == ERR_NONE) {
        return;
    }
    char *shown = printable_copy(prefix, false);
    const size_t size = strlen(shown) + strlen(err->text) + sizeof ": ";
    char *text = malloc(size);
    assert(text != NULL);
    snprintf(text, size, "%s: %s", shown, err->text);
    free(shown);
    take_lines(err, text);
}

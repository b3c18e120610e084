// How is an error carried to the one place that prints it?
#include "base/err.h"

#include "base/shorten.h"

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

void err_prefix(Err *err, const char *prefix)
{
    if (err->kind == ERR_NONE) {
        return;
    }
    const size_t size = strlen(prefix) + strlen(err->text) + sizeof ": ";
    char *text = malloc(size);
    assert(text != NULL);
    snprintf(text, size, "%s: %s", prefix, err->text);
    shorten_copy(err->text, sizeof err->text, text);
    free(text);
}

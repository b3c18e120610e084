// How is an error carried to the one place that prints it?
#include "base/err.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool err_set(Err *err, ErrKind kind, const char *format, ...)
{
    if (err->kind != ERR_NONE) {
        return false;
    }
    err->kind = kind;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(err->text, sizeof err->text, format, arguments);
    va_end(arguments);
    return false;
}

void err_prefix(Err *err, const char *prefix)
{
    if (err->kind == ERR_NONE) {
        return;
    }
    char text[ERR_TEXT_SIZE];
    memcpy(text, err->text, sizeof text);
    const int written = snprintf(err->text, sizeof err->text, "%s: ", prefix);
    if (written >= 0 && (size_t)written < sizeof err->text) {
        snprintf(err->text + written, sizeof err->text - (size_t)written, "%s", text);
    }
}

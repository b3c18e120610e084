// What a heading and a failure look like, as they are or marked for a terminal, and how wide a line
// may be.
#pragma once

#include <stddef.h>

typedef struct Style {
    const char *heading; // put in front of a heading
    const char *failure; // put in front of what failed
    const char *end;     // put behind either
    size_t width;        // the most characters of a line; 0: any number
} Style;

enum { STYLE_WIDTH = 80 }; // characters, where no terminal says another number

static const Style STYLE_PLAIN = {"", "", "", 0};
static const Style STYLE_TERMINAL = {"\x1b[1m", "\x1b[31m", "\x1b[0m", 0};

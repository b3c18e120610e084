// What a heading and a failure look like: as they are, or marked for a terminal.
#pragma once

typedef struct Style {
    const char *heading; // put in front of a heading
    const char *failure; // put in front of what failed
    const char *end;     // put behind either
} Style;

static const Style STYLE_PLAIN = {"", "", ""};
static const Style STYLE_TERMINAL = {"\x1b[1m", "\x1b[31m", "\x1b[0m"};

// A line on standard error that says how far something long has come, and is gone at its end: one
// line on a terminal, a plain line now and then elsewhere. Where quiet there is one
// warning, once the work takes long.
#pragma once

#include "base/text.h"

#include <stdbool.h>

// Work with less than that left, s, is over before a warning of it is read.
extern const double STATUS_LINE_SOON;

typedef struct StatusLine {
    bool is_quiet;
    bool is_terminal;
    bool is_shown;      // whether a line stands on the terminal
    bool is_warned;     // that it takes long, where it is quiet
    double started_s;   // by the clock
    double last_line_s; // wall time of the last line, s
} StatusLine;

StatusLine status_line_start(bool is_quiet);

// The time since the start, s.
double status_line_time(const StatusLine *line);

// Whether a line is due at this time after the start, s, with about so much left, s, INFINITY where
// that is not known; if so it counts as written. Where quiet, what is over soon is not worth one.
bool status_line_is_due(StatusLine *line, double wall_s, double left_s);

// Appends ", some 40 s left", in seconds, minutes or hours; nothing where none is left or it is not
// known.
void status_line_append_left(Text *words, double left_s);

// Appends an estimate of a time, s, in the unit that suits: "27 min".
void status_line_append_time(Text *words, double time_s);

// Writes the line.
void status_line_show(StatusLine *line, const char *words);

// Takes the line away again.
void status_line_end(StatusLine *line);

// Data on standard output, messages on standard error, and how they are laid out.
#pragma once

#include "base/err.h"
#include "base/text.h"
#include "write/json_value.h"
#include "write/table.h"

#include <stdbool.h>
#include <stdio.h>

// Marked for a terminal, plain for anything else and where NO_COLOR is set. Lines are as wide as
// the terminal is, by COLUMNS or as it reports, and STYLE_WIDTH elsewhere; of any width for wide
// tables.
Style output_style(FILE *stream, bool is_wide);

bool output_is_terminal(FILE *stream);

// From now on standard output keeps the reason why it could not be written. Once, before anything
// is printed.
void output_begin(void);

// Prints one JSON object to standard output; takes the reference.
void output_json(json_t *object);

// Says something on standard error. Arguments may hold anything, such as a path: what cannot be
// shown of them is escaped.
void output_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

// Makes a text for people fit to be printed or written to a file: its sentences are broken at the
// style's width, and what cannot be shown of it is escaped, but for the style's own marks.
void output_fold(Text *text, const Style *style);

// Prints a text for people to standard output, with its sentences broken at the style's width.
void output_text(Text *text, const Style *style);

// Sees that all of standard output has been written. Fails with ERR_FILE; the text is empty where
// the pipe was closed, which needs no message.
bool output_end(Err *err);

// Sentences about many things, joints for the most part: what holds of several is said once, with
// their names.
#pragma once

#include "base/text.h"

typedef struct Alike Alike;

Alike *alike_start(void);

// Adds what is said of a thing. It may have several lines; the last has no line break.
void alike_add(Alike *alike, const char *name, const char *said);

// Appends a line "LEAD NAME, NAME and 7 more" BETWEEN "SAID" for each sentence, in the order in
// which they came, and frees them. Of more sentences than anyone reads the first are shown where
// lines have a width (0: all).
void alike_end(Alike *alike, const char *lead, const char *between, size_t width, Text *text);
